// The real front end on rendered images, held against the truth.

#include "experiments/simulation/track_accuracy.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "common/support/random.h"
#include "experiments/simulation/depth_edge.h"
#include "experiments/simulation/render/renderer.h"
#include "experiments/simulation/warp_difference.h"
#include "frontend/frontend.h"
#include "test/experiments/simulation/render/small_world.h"

namespace duet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Timestamp kFrame = 50'000'000;

// 376 x 240 px, EuRoC's lens.
CameraModel HalfCamera() {
  CameraModel::Parameters parameters(9);
  parameters << 229.4, 228.6, 183.4, 124.1, -0.283, 0.0740, 1.9e-4, 1.8e-5, 0.0;
  return {DistortionModel::kRadialTangential, 376, 240, parameters};
}

RenderOptions Clean() {
  RenderOptions options;
  options.quality = RenderQuality::kAccurate;
  options.exposure_s = 0.0;
  options.photometry.vignetting = 0.0;
  options.photometry.noise_per_grey = 0.0;
  options.photometry.noise_floor = 0.0;
  return options;
}

struct Judged {
  TrackAccuracyReport report;
  TrackAccuracyReport without_shutter;  ///< empty for a global shutter
};

Judged TrackAndJudge(const RigCalibration& rig, const Vector3d& velocity, const Vector3d& omega,
                     int frames) {
  const auto room = NoisyRoom(true, 0.01);
  const auto motion = std::make_shared<SteadyMotion>(Vector3d(-2.0, -0.3, 1.4), velocity, omega);
  const Renderer renderer(Clean(), TrueCamera(rig, room, motion, 0));
  const TrueCamera no_shutter(rig, room, motion, 0, TrueCamera::Shutter::kMiddleRow);
  TrackAccuracy accuracy(&renderer.camera(), 0, {});
  TrackAccuracy accuracy_without(&no_shutter, 0, {});
  Frontend frontend(FrontendOptions{}, 120, rig);
  for (int frame = 0; frame < frames; ++frame) {
    const Timestamp stamp = frame * kFrame;
    for (int i = 0; i < 10; ++i) {
      frontend.AddImu({stamp - kFrame + (i + 1) * kFrame / 10, omega, {0, 0, 9.81}});
    }
    const cv::Mat image = renderer.Render(0, stamp).image;
    const TrackFrameSet& tracks = frontend.Process(stamp, {&image, 1});
    accuracy.Add(tracks.frames[0]);
    if (rig.t_r_s != 0.0) accuracy_without.Add(tracks.frames[0]);
  }
  return {accuracy.Report(), accuracy_without.Report()};
}

TEST(TrackAccuracy, FrontEndFollowsRenderedImagesToATenthOfAPixel) {
  const Judged judged =
      TrackAndJudge(ForwardRig(HalfCamera()), {0.3, 0.3, 0.05}, {0.05, 0.05, 0.15}, 20);
  const TrackAccuracyReport& report = judged.report;
  EXPECT_GT(report.frame_to_frame.count, 800);
  EXPECT_LT(report.frame_to_frame.rmse, 0.15);
  EXPECT_LT(report.frame_to_frame.median, 0.08);
  EXPECT_LT(report.edge_share, 0.3);
  EXPECT_LT(report.hidden_share, 0.01);
  ASSERT_GT(report.drift.size(), 15U);
  EXPECT_GT(report.drift[15].count, 20);
  EXPECT_LT(report.drift[15].median, 0.5);
  RecordProperty("rms", std::to_string(report.frame_to_frame.rmse));
  RecordProperty("median", std::to_string(report.frame_to_frame.median));
}

TEST(TrackAccuracy, RollingShutterIsInTheTruth) {
  RigCalibration rig = ForwardRig(HalfCamera());
  rig.t_r_s = 0.02;
  const Judged judged = TrackAndJudge(rig, {0.2, 0.3, 0.0}, {0.4, 0.3, 0.9}, 10);
  EXPECT_GT(judged.report.frame_to_frame.count, 250);
  EXPECT_LT(judged.report.frame_to_frame.rmse, 0.25);
  EXPECT_GT(judged.without_shutter.frame_to_frame.rmse, 2.0 * judged.report.frame_to_frame.rmse);
}

// Tracks that are the truth plus known errors.
TEST(TrackAccuracy, FindsTheErrorsThatWereMade) {
  RigCalibration rig = ForwardRig(QuarterCamera(DistortionModel::kEquidistant));
  rig.t_r_s = 0.02;
  const auto wall = Wall(2.0, 20.0, Texture(1, 1, 0.01, {100}));
  const auto motion = std::make_shared<SteadyMotion>(Vector3d::Zero(), Vector3d(0.1, 0.2, 0),
                                                     Vector3d(0.1, 0.2, 0.3));
  const TrueCamera truth(rig, wall, motion, 0);
  TrackAccuracy accuracy(&truth, 0, {});
  Random random(1);
  constexpr double kSigma = 0.2;
  std::vector<SurfacePoint> points;
  for (int i = 0; i < 200; ++i) {
    points.push_back(*truth.PointAt(0, 0, {random.Uniform(40, 148), random.Uniform(30, 90)}));
  }
  for (int frame = 0; frame < 10; ++frame) {
    TrackFrame tracks;
    tracks.timestamp = frame * kFrame;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector2d uv = *truth.PixelOf(0, tracks.timestamp, points[i]) +
                          kSigma * random.NormalVector<2>() + Vector2d(0.05 * frame, 0);
      tracks.observations.push_back({i, static_cast<float>(uv.x()), static_cast<float>(uv.y())});
    }
    accuracy.Add(tracks);
  }
  const TrackAccuracyReport report = accuracy.Report();
  EXPECT_EQ(report.frame_to_frame.count, 1800);
  EXPECT_EQ(report.edge_share, 0.0);
  // Two ends with noise on two axes each, and the drift's step.
  EXPECT_NEAR(report.frame_to_frame.rmse, std::sqrt(4.0 * kSigma * kSigma + 0.05 * 0.05), 0.02);
  EXPECT_NEAR(report.drift[9].rmse, std::sqrt(4.0 * kSigma * kSigma + 0.45 * 0.45), 0.06);
}

TEST(NearDepthEdge, JumpsAreEdgesAndCornersOfARoomAreNot) {
  const auto room = NoisyRoom(true, 0.1);
  const auto at_rest =
      std::make_shared<SteadyMotion>(Vector3d(-2.0, -0.3, 1.4), Vector3d::Zero(), Vector3d::Zero());
  const TrueCamera truth(ForwardRig(HalfCamera()), room, at_rest, 0);
  const auto near_edge = [&](const Vector3d& p_G) {
    Vector2d uv;
    EXPECT_TRUE(truth.model(0).Project(truth.PoseAt(0, 0.0) * p_G, &uv));
    return NearDepthEdge(truth, 0, 0, uv, 5.0);
  };
  EXPECT_FALSE(near_edge({3.0, 1.0, 2.2})) << "on the wall";
  EXPECT_FALSE(near_edge({3.0, -2.6, 0.0})) << "where wall and floor meet";
  EXPECT_FALSE(near_edge({3.0, 3.0, 1.0})) << "where two walls meet";
  EXPECT_FALSE(near_edge({1.2, -1.25, 0.7})) << "a box's edge between two faces that are seen";
  EXPECT_TRUE(near_edge({1.2, -1.5, 0.5})) << "the side of a box before the wall";
  EXPECT_TRUE(near_edge({2.2, 0.1, 1.4})) << "the side of the hanging box";
  EXPECT_TRUE(near_edge({0.9, 0.09, 1.3})) << "the box that moves";
}

TEST(CompareByWarp, LeavesTheNoiseAlone) {
  RigCalibration rig = ForwardRig(QuarterCamera(DistortionModel::kRadialTangential));
  rig.t_r_s = 0.02;
  const auto room = NoisyRoom(true, 0.02);
  const auto motion = std::make_shared<SteadyMotion>(
      Vector3d(-2.0, -0.3, 1.4), Vector3d(0.3, 0.4, 0), Vector3d(0.1, 0.1, 0.4));
  RenderOptions options = Clean();
  const auto compare = [&](const TrueCamera& truth) {
    const Renderer renderer(options, TrueCamera(rig, room, motion, 0));
    return CompareByWarp(truth, 0, 0, renderer.Render(0, 0).image, kFrame,
                         renderer.Render(0, kFrame).image, 5);
  };
  const TrueCamera truth(rig, room, motion, 0);
  const WarpDifference clean = compare(truth);
  EXPECT_GT(clean.share, 0.5);
  // What is left of cubic interpolation, at the creases of the room above all.
  EXPECT_LT(clean.rms_grey, 3.0);
  EXPECT_LT(std::abs(clean.mean_grey), 0.1);

  options.photometry.noise_floor = 16.0;
  const WarpDifference noisy = compare(truth);
  // One image's noise, and the other's as the interpolation leaves it (0.5 to 1 of its variance).
  const double noise = std::sqrt(noisy.rms_grey * noisy.rms_grey - clean.rms_grey * clean.rms_grey);
  EXPECT_GT(noise, 4.0 * std::sqrt(1.5));
  EXPECT_LT(noise, 4.0 * std::sqrt(2.05));

  options.photometry.noise_floor = 0.0;
  // A rate that is off by 0.1 rad/s: 0.6 px from one frame to the next.
  const auto wrong = std::make_shared<SteadyMotion>(Vector3d(-2.0, -0.3, 1.4),
                                                    Vector3d(0.3, 0.4, 0), Vector3d(0.1, 0.1, 0.5));
  EXPECT_GT(compare(TrueCamera(rig, room, wrong, 0)).rms_grey, 2.0 * clean.rms_grey);
}

}  // namespace
}  // namespace duet
