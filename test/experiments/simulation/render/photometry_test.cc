#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "experiments/simulation/render/renderer.h"
#include "test/experiments/simulation/render/small_world.h"

namespace duet {
namespace {

using Eigen::Vector3d;

constexpr double kGrey = 100.0;

RigCalibration Rig() { return ForwardRig(QuarterCamera(DistortionModel::kRadialTangential)); }

std::shared_ptr<const Trajectory> AtRest() {
  return std::make_shared<SteadyMotion>(Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero());
}

std::shared_ptr<const World> GreyWall(std::uint8_t grey = static_cast<std::uint8_t>(kGrey)) {
  return Wall(2.0, 20.0, Texture(1, 1, 0.01, {grey}));
}

RenderOptions Options() {
  RenderOptions options;
  options.exposure_s = 0.0;
  options.photometry.vignetting = 0.0;
  options.photometry.noise_per_grey = 0.0;
  options.photometry.noise_floor = 0.0;
  return options;
}

struct Moments {
  double mean = 0.0;
  double variance = 0.0;
};
Moments MomentsOf(const cv::Mat& image) {
  cv::Scalar mean, sigma;
  cv::meanStdDev(image, mean, sigma);
  return {mean[0], sigma[0] * sigma[0]};
}

TEST(Photometry, NoiseHasTheVarianceThatIsAskedFor) {
  struct Setting {
    double gain, per_grey, floor;
  };
  for (const Setting& s : {Setting{1.0, 0.0, 4.0}, Setting{1.0, 0.06, 0.0}, Setting{1.0, 0.03, 2.0},
                           Setting{1.8, 0.03, 2.0}}) {
    RenderOptions options = Options();
    options.photometry.gain = s.gain;
    options.photometry.noise_per_grey = s.per_grey;
    options.photometry.noise_floor = s.floor;
    const Renderer renderer(options, TrueCamera(Rig(), GreyWall(), AtRest(), 0));
    const Moments moments = MomentsOf(renderer.Render(0, 0).image);
    const double signal = s.gain * kGrey;
    // Rounding to whole levels adds 1 / 12.
    const double variance = s.gain * s.per_grey * signal + s.gain * s.gain * s.floor + 1.0 / 12.0;
    const double pixels = 188.0 * 120.0;
    EXPECT_NEAR(moments.mean, signal, 4.0 * std::sqrt(variance / pixels));
    EXPECT_NEAR(moments.variance, variance, 4.0 * variance * std::sqrt(2.0 / pixels));
  }
}

TEST(Photometry, NoiseIsIndependentBetweenFramesAndRows) {
  RenderOptions options = Options();
  options.photometry.noise_floor = 25.0;
  const Renderer renderer(options, TrueCamera(Rig(), GreyWall(), AtRest(), 0));
  cv::Mat a, b;
  renderer.Render(0, 0).image.convertTo(a, CV_64F);
  renderer.Render(0, 50'000'000).image.convertTo(b, CV_64F);
  a -= kGrey;
  b -= kGrey;
  const double scale = 25.0 * static_cast<double>(a.total());
  const double bound = 4.0 / std::sqrt(static_cast<double>(a.total()));
  EXPECT_LT(std::abs(a.dot(b)) / scale, bound);
  const cv::Mat upper = a.rowRange(0, a.rows - 1).clone();
  const cv::Mat lower = a.rowRange(1, a.rows).clone();
  EXPECT_LT(std::abs(upper.dot(lower)) / scale, bound);
}

TEST(Photometry, VignettingTakesItsShareFromTheFarthestCorner) {
  RenderOptions options = Options();
  options.photometry.vignetting = 0.4;
  const Renderer renderer(options, TrueCamera(Rig(), GreyWall(200), AtRest(), 0));
  const cv::Mat image = renderer.Render(0, 0).image;
  // The principal point is at (91.5, 61.8): the corner (187, 0) is the farthest.
  EXPECT_NEAR(image.at<std::uint8_t>(62, 91), 200, 1);
  EXPECT_NEAR(image.at<std::uint8_t>(0, 187), 120, 1);
  const double share = (95.5 * 95.5) / (95.5 * 95.5 + 61.8 * 61.8);
  EXPECT_NEAR(image.at<std::uint8_t>(62, 187), 200.0 * (1.0 - 0.4 * share), 1);
}

TEST(Photometry, LightAndGainMultiplyAndClip) {
  RenderOptions options = Options();
  options.photometry.light = 0.3;
  const Renderer dark(options, TrueCamera(Rig(), GreyWall(), AtRest(), 0));
  EXPECT_NEAR(MomentsOf(dark.Render(0, 0).image).mean, 30.0, 1e-9);
  options.photometry.gain = 20.0;
  const Renderer bright(options, TrueCamera(Rig(), GreyWall(), AtRest(), 0));
  EXPECT_NEAR(MomentsOf(bright.Render(0, 0).image).mean, 255.0, 1e-9);
}

TEST(Photometry, GainChangesSmoothlyAndByTheSeed) {
  RenderOptions options = Options();
  options.photometry.gain_change = 0.3;
  options.photometry.gain_period_s = 3.0;
  const TrueCamera camera(Rig(), GreyWall(), AtRest(), 0);
  const GainControl gain(options.photometry, &camera, 1);
  const GainControl other(options.photometry, &camera, 2);
  double low = 1e9, high = 0.0, step = 0.0, difference = 0.0;
  double before = gain.GainAt(0, 0);
  for (int i = 1; i < 400; ++i) {
    const Timestamp stamp = i * 25'000'000LL;
    const double now = gain.GainAt(0, stamp);
    low = std::min(low, now);
    high = std::max(high, now);
    step = std::max(step, std::abs(now - before));
    difference = std::max(difference, std::abs(now - other.GainAt(0, stamp)));
    before = now;
  }
  EXPECT_LT(low, 0.85);
  EXPECT_GT(low, 0.65);
  EXPECT_GT(high, 1.15);
  EXPECT_LT(high, 1.55);
  // At most gain_change * 3 terms * the rate * 25 ms.
  EXPECT_LT(step, 0.3 * 3 * 1.1 * 2.1 * 0.025 * 1.5);
  EXPECT_GT(difference, 0.1);
}

TEST(Photometry, AutoExposureFollowsTheLightWithItsLag) {
  // A dark half world to the left, a bright one to the right; the camera turns from one to the
  // other.
  const auto world = Wall(2.0, 20.0, Texture(1, 1, 0.01, {40}));
  Surface bright = world->surfaces()[0];
  bright.corner = {-2.0, 20.0, 20.0};
  bright.brightness = 4.0;
  world->AddSurface(bright);
  const auto turning = std::make_shared<SteadyMotion>(Vector3d::Zero(), Vector3d::Zero(),
                                                      Vector3d(0, 0, 3.14159265));
  RenderOptions options = Options();
  options.photometry.auto_exposure = true;
  options.photometry.auto_exposure_grey = 100.0;
  options.photometry.auto_exposure_lag_s = 0.1;
  const Renderer renderer(options, TrueCamera(Rig(), world, turning, 0));
  EXPECT_NEAR(renderer.Render(0, 0).gain, 2.5, 0.01);
  EXPECT_NEAR(MomentsOf(renderer.Render(0, 0).image).mean, 100.0, 1.0);
  // After half a turn it sees 160, and looked at nothing else for 2 lags.
  EXPECT_NEAR(renderer.Render(0, 1'000'000'000).gain, 100.0 / 160.0, 0.01);
  options.photometry.auto_exposure_max_gain = 2.0;
  const Renderer bounded(options, TrueCamera(Rig(), world, turning, 0));
  EXPECT_EQ(bounded.Render(0, 0).gain, 2.0);
}

}  // namespace
}  // namespace duet
