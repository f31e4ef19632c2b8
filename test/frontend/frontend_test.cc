// The front end as a whole on rendered images with known motion.

#include "frontend/frontend.h"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

constexpr Timestamp kFrame = 50'000'000;
constexpr Timestamp kSample = 5'000'000;
constexpr int kFrames = 24;
const Eigen::Vector3d kBias(0.03, -0.02, 0.05);

/// A rig that sways in front of the wall and turns at a constant rate about `axis_B`.
class Sequence {
 public:
  Sequence(bool stereo, double turn_rad_per_s, int frames = kFrames,
           const Eigen::Vector3d& axis_B = {0.35, 0.2, 0.9})
      : rig_(SmallRig(stereo)), omega_B_(turn_rad_per_s * axis_B.normalized()), frames_(frames) {
    const SyntheticScene scene(4);
    for (int frame = 0; frame < frames; ++frame) {
      for (std::size_t camera = 0; camera < rig_.cameras.size(); ++camera) {
        images_[frame].push_back(
            scene.Render(rig_.cameras[camera].model, CameraPose(rig_, camera, BodyPose(frame))));
      }
    }
  }

  static Eigen::Vector3d Position(double t_s) {
    return {0.5 * std::sin(1.3 * t_s), 0.3 * std::sin(1.9 * t_s + 0.4), 0.25 * std::sin(1.1 * t_s)};
  }
  // Turns at a constant rate in B, so that the gyro's reading is simple; from minus half the turn
  // to plus half, so that the wall stays in view.
  [[nodiscard]] Pose BodyPose(int frame) const {
    const double t_s = 0.05 * frame;
    return {ExpQuaternion((t_s - 0.5 * 0.05 * (frames_ - 1)) * omega_B_), Position(t_s)};
  }

  void Feed(Frontend* frontend, int frame) const {
    const Timestamp from = (frame - 1) * kFrame;
    for (Timestamp t = from + kSample; t <= frame * kFrame; t += kSample) {
      frontend->AddImu({t, omega_B_ + kBias, Eigen::Vector3d(0, 0, 9.81)});
    }
  }

  [[nodiscard]] std::vector<TrackFrameSet> Run(Frontend* frontend) const {
    std::vector<TrackFrameSet> stream;
    for (const auto& [frame, images] : images_) {
      Feed(frontend, frame);
      stream.push_back(frontend->Process(frame * kFrame, images));
    }
    return stream;
  }

  // Distance of an observation of a later frame from where its first observation's point is.
  [[nodiscard]] double Error(const TrackObservation& first, int first_frame,
                             const TrackObservation& later, int frame, std::size_t camera) const {
    const auto point = SyntheticScene::PointAt(
        rig_.cameras[0].model, CameraPose(rig_, 0, BodyPose(first_frame)), {first.u, first.v});
    const auto truth = SyntheticScene::PixelOf(rig_.cameras[camera].model,
                                               CameraPose(rig_, camera, BodyPose(frame)), *point);
    return truth ? (*truth - Eigen::Vector2d(later.u, later.v)).norm() : 1e9;
  }

  RigCalibration rig_;
  Eigen::Vector3d omega_B_;
  int frames_;
  std::map<int, std::vector<cv::Mat>> images_;
};

FrontendOptions DefaultOptions() {
  FrontendOptions options;
  options.min_distance_px = 12.0;
  options.outlier_threshold_px = 0.7;  // the camera has half of EuRoC's pixels
  return options;
}

const Sequence& Mono() {
  static const Sequence sequence(false, 0.3);
  return sequence;
}
const Sequence& Stereo() {
  static const Sequence sequence(true, 0.3, 8);
  return sequence;
}

std::vector<double> Errors(const Sequence& sequence, const std::vector<TrackFrameSet>& stream) {
  std::map<std::uint64_t, std::pair<TrackObservation, int>> first;
  std::vector<double> errors;
  for (std::size_t frame = 0; frame < stream.size(); ++frame) {
    for (const TrackObservation& o : stream[frame].frames[0].observations) {
      const auto [start, is_new] = first.try_emplace(o.track_id, o, static_cast<int>(frame));
      if (is_new) continue;
      errors.push_back(
          sequence.Error(start->second.first, start->second.second, o, static_cast<int>(frame), 0));
    }
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

std::string Bytes(const std::vector<TrackFrameSet>& stream) {
  std::string bytes;
  for (const TrackFrameSet& set : stream) {
    for (const TrackFrame& frame : set.frames) {
      for (const TrackObservation& o : frame.observations) {
        char buffer[16];
        std::memcpy(buffer, &o.track_id, 8);
        std::memcpy(buffer + 8, &o.u, 4);
        std::memcpy(buffer + 12, &o.v, 4);
        bytes.append(buffer, sizeof(buffer));
      }
    }
  }
  return bytes;
}

TEST(FrontendTest, TracksStayOnTheirPoints) {
  Frontend frontend(DefaultOptions(), 100, Mono().rig_);
  const std::vector<TrackFrameSet> stream = Mono().Run(&frontend);
  const std::vector<double> errors = Errors(Mono(), stream);
  ASSERT_GT(errors.size(), 1500U);
  // Against the very first observation, up to 24 frames before: nothing adds up.
  EXPECT_LT(errors[errors.size() / 2], 0.08);
  EXPECT_LT(errors[errors.size() * 95 / 100], 0.3);
  EXPECT_LT(errors[errors.size() * 99 / 100], 1.0);
  // Most of the wall stays in view.
  EXPECT_GE(frontend.statistics().total.kept, 75 * (kFrames - 1));
}

TEST(FrontendTest, StreamKeepsItsContract) {
  Frontend frontend(DefaultOptions(), 60, Mono().rig_);
  std::set<std::uint64_t> alive;
  std::set<std::uint64_t> seen;
  for (const TrackFrameSet& set : Mono().Run(&frontend)) {
    ASSERT_EQ(set.frames.size(), 1U);
    const auto& observations = set.frames[0].observations;
    EXPECT_LE(observations.size(), 60U);
    EXPECT_EQ(set.frames[0].timestamp, set.timestamp);
    std::set<std::uint64_t> now;
    for (std::size_t i = 0; i < observations.size(); ++i) {
      if (i > 0) {
        EXPECT_LT(observations[i - 1].track_id, observations[i].track_id);
      }
      const std::uint64_t id = observations[i].track_id;
      // Never reused: an id that is not alive is a new one.
      if (!alive.contains(id)) {
        EXPECT_TRUE(seen.insert(id).second) << id;
      }
      now.insert(id);
      for (std::size_t j = 0; j < i; ++j) {
        // Half the distance of new corners for tracks that have come together.
        EXPECT_GE(std::hypot(observations[i].u - observations[j].u,
                             observations[i].v - observations[j].v),
                  0.5 * DefaultOptions().min_distance_px - 1e-4);
      }
    }
    alive = now;
  }
}

TEST(FrontendTest, FindsTheGyroscopesBias) {
  Frontend frontend(DefaultOptions(), 100, Mono().rig_);
  (void)Mono().Run(&frontend);
  // Rotation and sideways motion in front of a wall look alike: a tenth of a pixel a frame is
  // 0.01 rad/s here.
  EXPECT_LT((frontend.statistics().b_g - kBias).norm(), 0.01);
}

TEST(FrontendTest, SameBytesForOneAndTwoThreadsAndTwice) {
  std::vector<std::string> bytes;
  for (const int threads : {1, 2, 1}) {
    FrontendOptions options = DefaultOptions();
    options.threads = threads;
    Frontend frontend(options, 80, Stereo().rig_);
    bytes.push_back(Bytes(Stereo().Run(&frontend)));
  }
  EXPECT_GT(bytes[0].size(), 10000U);
  EXPECT_EQ(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[0], bytes[2]);
}

// 6 rad/s, mostly to the side, is 17 degrees or 70 px a frame: beyond what the pyramid bridges.
TEST(FrontendTest, TheGyroscopeCarriesTracksThroughFastTurns) {
  const Sequence fast(false, 6.0, 3, {0.25, 1.0, 0.1});
  std::array<int, 2> kept;
  for (const bool prediction : {false, true}) {
    FrontendOptions options = DefaultOptions();
    options.gyro_prediction = prediction;
    Frontend frontend(options, 80, fast.rig_);
    (void)fast.Run(&frontend);
    kept[prediction] = frontend.statistics().total.kept;
  }
  EXPECT_GE(kept[1], 40);
  EXPECT_LE(kept[0], kept[1] / 4);
}

TEST(FrontendTest, BothCamerasSeeTheSamePointUnderOneId) {
  Frontend frontend(DefaultOptions(), 80, Stereo().rig_);
  const std::vector<TrackFrameSet> stream = Stereo().Run(&frontend);
  std::vector<double> errors;
  for (std::size_t frame = 0; frame < stream.size(); ++frame) {
    std::map<std::uint64_t, TrackObservation> left;
    for (const TrackObservation& o : stream[frame].frames[0].observations) left[o.track_id] = o;
    EXPECT_GE(stream[frame].frames[1].observations.size(), left.size() * 7 / 10);
    for (const TrackObservation& o : stream[frame].frames[1].observations) {
      ASSERT_TRUE(left.contains(o.track_id));
      const int number = static_cast<int>(frame);
      errors.push_back(Stereo().Error(left[o.track_id], number, o, number, 1));
    }
  }
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.7);
  EXPECT_EQ(frontend.statistics().total.stereo_matched, static_cast<int>(errors.size()));
}

TEST(FrontendTest, AnUnreadableSecondImageEndsNoTrack) {
  Frontend whole(DefaultOptions(), 80, Stereo().rig_);
  Frontend lacking(DefaultOptions(), 80, Stereo().rig_);
  const std::vector<TrackFrameSet> expected = Stereo().Run(&whole);
  for (const auto& [frame, images] : Stereo().images_) {
    Stereo().Feed(&lacking, frame);
    std::vector<cv::Mat> given = images;
    if (frame == 3) given[1] = cv::Mat();
    const TrackFrameSet& set = lacking.Process(frame * kFrame, given);
    ASSERT_EQ(set.frames.size(), 2U);
    EXPECT_EQ(set.frames[1].observations.empty(), frame == 3);
    EXPECT_EQ(set.frames[0].observations.size(),
              expected[static_cast<std::size_t>(frame)].frames[0].observations.size());
  }
}

TEST(FrontendTest, RunsWithoutImuAndWithClahe) {
  FrontendOptions options = DefaultOptions();
  options.clahe = true;
  Frontend frontend(options, 60, Mono().rig_);
  for (int frame = 0; frame < 4; ++frame) {
    (void)frontend.Process(frame * kFrame, Mono().images_.at(frame));
  }
  EXPECT_GE(frontend.statistics().total.kept, 100);
  EXPECT_EQ(frontend.statistics().b_g, Eigen::Vector3d::Zero());
}

TEST(FrontendTest, SurvivesDarknessAndDetectsAgain) {
  Frontend frontend(DefaultOptions(), 60, Mono().rig_);
  (void)frontend.Process(0, Mono().images_.at(0));
  const std::vector<cv::Mat> dark = {cv::Mat(240, 376, CV_8U, cv::Scalar(3))};
  EXPECT_TRUE(frontend.Process(kFrame, dark).frames[0].observations.empty());
  EXPECT_EQ(frontend.Process(2 * kFrame, Mono().images_.at(2)).frames[0].observations.size(), 60U);
}

}  // namespace
}  // namespace duet
