// Where things appear in rendered images, against the camera model and a motion written out here.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <opencv2/core.hpp>

#include "experiments/simulation/render/renderer.h"
#include "test/experiments/simulation/render/small_world.h"

namespace duet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Timestamp kStart = 1'400'000'000'000'000'000;
constexpr double kLow = 40.0;
constexpr double kHigh = 220.0;

RenderOptions Clean(RenderQuality quality) {
  RenderOptions options;
  options.quality = quality;
  options.exposure_s = 0.0;
  options.photometry.vignetting = 0.0;
  options.photometry.noise_per_grey = 0.0;
  options.photometry.noise_floor = 0.0;
  return options;
}

// Where a point at rest is seen, by the definition of DESIGN.md section 3 and nothing of the
// renderer.
Vector2d ExpectedPixel(const RigCalibration& rig, const Trajectory& trajectory, Timestamp stamp,
                       const Vector3d& p_G) {
  const CameraCalibration& camera = rig.cameras[0];
  Vector2d uv(0, 0);
  for (int i = 0; i < 30; ++i) {
    const double line = rig.readout_by_columns ? uv.x() : uv.y();
    const double count =
        rig.readout_by_columns ? camera.model.width_px() : camera.model.height_px();
    const double t_s = SecondsBetween(kStart, stamp) + rig.t_d_s +
                       (line - 0.5 * (count - 1.0)) * rig.t_r_s / count;
    const Pose T_GB = trajectory.At(t_s).T_GB;
    const Vector3d p_B = T_GB.R.conjugate() * (p_G - T_GB.p);
    EXPECT_TRUE(camera.model.Project(camera.R_CB * p_B + camera.p_CB, &uv));
  }
  return uv;
}

// The u at which a row goes from kLow to kHigh, from the light between: each pixel is the share of
// it that lies on the high side.
double UprightEdge(const cv::Mat& image, int v, int from_u, int to_u) {
  double low_pixels = 0.0;
  for (int u = from_u; u < to_u; ++u) {
    low_pixels += (kHigh - image.at<std::uint8_t>(v, u)) / (kHigh - kLow);
  }
  return from_u - 0.5 + low_pixels;
}

struct EdgeErrors {
  double mean = 0.0;
  double rms = 0.0;
  int rows = 0;
};

// The edge along z at y = `y`, x = `x` in G: measured minus expected u, over rows. `transposed`:
// the same for an edge that lies across, along y at z = `y`, over columns.
EdgeErrors CompareEdge(const cv::Mat& given, const RigCalibration& rig, const Trajectory& motion,
                       Timestamp stamp, double x, double y, bool transposed) {
  const cv::Mat image = transposed ? cv::Mat(given.t()) : given;
  // Where the edge is expected, as points (across, along).
  std::vector<Vector2d> edge;
  for (double along = 0.35; along >= -0.35; along -= 0.002) {
    const Vector3d p_G = transposed ? Vector3d(x, along, y) : Vector3d(x, y, along);
    const Vector2d uv = ExpectedPixel(rig, motion, stamp, p_G);
    edge.emplace_back(transposed ? uv.y() : uv.x(), transposed ? uv.x() : uv.y());
  }
  EdgeErrors errors;
  double squares = 0.0;
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    const int line = static_cast<int>(std::ceil(edge[i].y()));
    if (line >= edge[i + 1].y() || line < 0 || line >= image.rows) continue;
    const double share = (line - edge[i].y()) / (edge[i + 1].y() - edge[i].y());
    const double expected = edge[i].x() + share * (edge[i + 1].x() - edge[i].x());
    const int middle = static_cast<int>(std::lround(expected));
    const double error = UprightEdge(image, line, middle - 9, middle + 10) - expected;
    errors.mean += error;
    squares += error * error;
    ++errors.rows;
  }
  EXPECT_GT(errors.rows, 20);
  errors.mean /= errors.rows;
  errors.rms = std::sqrt(squares / errors.rows);
  return errors;
}

struct Case {
  DistortionModel model;
  double t_r_s;
  bool by_columns;
  RenderQuality quality;
};

class RenderedEdges : public testing::TestWithParam<Case> {
 protected:
  RenderedEdges() {
    rig_ = ForwardRig(QuarterCamera(GetParam().model));
    rig_.t_r_s = GetParam().t_r_s;
    rig_.t_d_s = 0.007;
    rig_.readout_by_columns = GetParam().by_columns;
    rig_.cameras[0].p_CB = {0.01, -0.02, 0.03};
  }

  RigCalibration rig_;
  std::shared_ptr<const Trajectory> motion_ = std::make_shared<SteadyMotion>(
      Vector3d(0.02, -0.03, 0.01), Vector3d(0.1, 0.3, -0.2), Vector3d(0.3, -0.4, 0.9));
  const Timestamp stamp_ = kStart + 50'000'000;
};

// A border within a texture: mip levels, probes and interpolation leave it where it is.
TEST_P(RenderedEdges, InATextureIsWhereTheCameraModelPutsIt) {
  // Texels from much finer than a pixel (17 mm) to a third of one.
  for (const double texel_m : {0.001, 0.006}) {
    for (const double border_m : {0.75, 1.2}) {
      const auto world = Wall(2.0, 1.0, StepTexture(2.0, 2.0, texel_m, border_m, kLow, kHigh));
      // The wall is seen from behind (two-sided): u goes to -y.
      const Renderer renderer(Clean(GetParam().quality), TrueCamera(rig_, world, motion_, kStart));
      const RenderedImage rendered = renderer.Render(0, stamp_);
      const double y = 1.0 - border_m;
      const EdgeErrors errors = CompareEdge(rendered.image, rig_, *motion_, stamp_, 2.0, y, false);
      // The border as a whole, and single rows: with their place among texels and pixels these
      // differ a little, with one sample a pixel more (TextureSampler::OverByFour).
      const bool accurate = GetParam().quality == RenderQuality::kAccurate;
      EXPECT_LT(std::abs(errors.mean), accurate ? 0.01 : 0.04) << texel_m << " " << border_m;
      EXPECT_LT(errors.rms, accurate ? 0.025 : 0.05) << texel_m << " " << border_m;
    }
  }
}

// The border of a surface before another, upright and lying: what the edge samples are for.
TEST_P(RenderedEdges, OfASurfaceIsWhereTheCameraModelPutsIt) {
  const auto world = std::make_shared<World>("two");
  Surface surface;
  surface.two_sided = true;
  surface.u_axis = -Vector3d::UnitY();
  surface.v_axis = -Vector3d::UnitZ();
  surface.width_m = surface.height_m = 8.0;
  surface.corner = {3.0, 4.0, 4.0};
  surface.texture = world->AddTexture(Texture(1, 1, 0.01, {static_cast<std::uint8_t>(kHigh)}));
  world->AddSurface(surface);
  // In front: dark, its right border at y = 0.11, its lower one at z = 0.07.
  surface.corner = {2.0, 3.11, 3.07};
  surface.width_m = surface.height_m = 3.0;
  surface.texture = world->AddTexture(Texture(1, 1, 0.01, {static_cast<std::uint8_t>(kLow)}));
  world->AddSurface(surface);
  for (const bool lying : {false, true}) {
    // Each alone: the other border is moved out of the way.
    auto one = std::make_shared<World>("one");
    one->AddTexture(world->textures()[0]);
    one->AddTexture(world->textures()[1]);
    Surface back = world->surfaces()[0];
    Surface front = world->surfaces()[1];
    (lying ? front.width_m : front.height_m) = 6.0;
    one->AddSurface(back);
    one->AddSurface(front);
    const Renderer renderer(Clean(GetParam().quality), TrueCamera(rig_, one, motion_, kStart));
    const RenderedImage rendered = renderer.Render(0, stamp_);
    const EdgeErrors errors =
        CompareEdge(rendered.image, rig_, *motion_, stamp_, 2.0, lying ? 0.07 : 0.11, lying);
    // A pixel's coverage is known to 1 / samples.
    const bool accurate = GetParam().quality == RenderQuality::kAccurate;
    EXPECT_LT(std::abs(errors.mean), 0.008) << lying;
    EXPECT_LT(errors.rms, accurate ? 0.02 : 0.04) << lying;
  }
}

// The rows' poses matter here: taken for a global shutter the same image is off by pixels.
TEST(RenderedEdge, RollingShutterIsNoGlobalOne) {
  RigCalibration rig = ForwardRig(QuarterCamera(DistortionModel::kRadialTangential));
  rig.t_r_s = 0.02;
  const auto motion =
      std::make_shared<SteadyMotion>(Vector3d::Zero(), Vector3d::Zero(), Vector3d(0, 0, 1.0));
  const auto world = Wall(2.0, 1.0, StepTexture(2.0, 2.0, 0.006, 0.9, kLow, kHigh));
  const Renderer renderer(Clean(RenderQuality::kFast), TrueCamera(rig, world, motion, kStart));
  const RenderedImage rendered = renderer.Render(0, kStart);
  rig.t_r_s = 0.0;
  const EdgeErrors errors = CompareEdge(rendered.image, rig, *motion, kStart, 2.0, 0.1, false);
  EXPECT_GT(errors.rms, 0.2);
}

// Blur takes light symmetrically from both sides: the border stays, though it gets soft.
TEST_P(RenderedEdges, StayInPlaceWhenBlurred) {
  RenderOptions options = Clean(GetParam().quality);
  options.exposure_s = 0.03;
  const auto world = Wall(2.0, 1.0, StepTexture(2.0, 2.0, 0.006, 0.9, kLow, kHigh));
  const Renderer renderer(options, TrueCamera(rig_, world, motion_, kStart));
  const RenderedImage rendered = renderer.Render(0, stamp_);
  EXPECT_GE(rendered.blur_instants, 2);
  const EdgeErrors errors = CompareEdge(rendered.image, rig_, *motion_, stamp_, 2.0, 0.1, false);
  // The mean over the exposure of where it is differs from where it is in the middle by the path's
  // bend, ~ f omega^2 x exposure^2 / 24 = 0.005 px.
  const bool accurate = GetParam().quality == RenderQuality::kAccurate;
  EXPECT_LT(std::abs(errors.mean), accurate ? 0.015 : 0.045);
  EXPECT_LT(errors.rms, accurate ? 0.02 : 0.05);
  // It is soft: more pixels between the two levels than without.
  const auto between = [](const cv::Mat& image) {
    int count = 0;
    for (int u = 0; u < image.cols; ++u) {
      const int grey = image.at<std::uint8_t>(60, u);
      if (grey > kLow + 5 && grey < kHigh - 5) ++count;
    }
    return count;
  };
  const Renderer sharp(Clean(GetParam().quality), TrueCamera(rig_, world, motion_, kStart));
  EXPECT_GT(between(rendered.image), between(sharp.Render(0, stamp_).image));
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, RenderedEdges,
    testing::Values(Case{DistortionModel::kRadialTangential, 0.0, false, RenderQuality::kAccurate},
                    Case{DistortionModel::kRadialTangential, 0.0, false, RenderQuality::kFast},
                    Case{DistortionModel::kRadialTangential, 0.02, false, RenderQuality::kAccurate},
                    Case{DistortionModel::kRadialTangential, -0.02, false, RenderQuality::kFast},
                    Case{DistortionModel::kRadialTangential, 0.02, true, RenderQuality::kAccurate},
                    Case{DistortionModel::kEquidistant, 0.0, false, RenderQuality::kAccurate},
                    Case{DistortionModel::kEquidistant, 0.02, false, RenderQuality::kAccurate},
                    Case{DistortionModel::kEquidistant, 0.02, true, RenderQuality::kFast}));

TEST(RayTable, RaysWithinAPixelAreTheModels) {
  CameraModel::Parameters wide(8);  // a fisheye of 512 px and f = 190 px, as TUM-VI's
  wide << 190.98, 190.97, 254.93, 256.9, 0.0034, 0.00072, -0.00205, 0.0002;
  const CameraModel fisheye(DistortionModel::kEquidistant, 512, 512, wide);
  for (const CameraModel& model : {QuarterCamera(DistortionModel::kRadialTangential),
                                   QuarterCamera(DistortionModel::kEquidistant), fisheye}) {
    const RayTable table(model);
    for (int v = 3; v < model.height_px(); v += 17) {
      for (int u = 3; u < model.width_px(); u += 17) {
        const auto direction = model.Unproject({u, v});
        if (!direction || direction->head<2>().norm() > 2.7) continue;  // 70 degrees
        ASSERT_TRUE(table.valid(u, v));
        for (const auto& [du, dv] : {std::pair{0.0F, 0.0F}, {0.3F, -0.2F}, {-0.5F, 0.1F}}) {
          const Eigen::Vector2f ray = table.At(u, v).At(du, dv);
          Vector2d uv;
          ASSERT_TRUE(model.Project({ray.x(), ray.y(), 1.0}, &uv));
          EXPECT_LT((uv - Vector2d(u, v) - Vector2d(du, dv)).norm(), 2.5e-3);
        }
      }
    }
  }
}

TEST(Renderer, BlackWhereThereIsNoRayAndEmptyWhereThereIsNoSurface) {
  // A fisheye that sees more than half the world in its corners.
  CameraModel::Parameters parameters(8);
  parameters << 40.0, 40.0, 59.5, 59.5, 0.0, 0.0, 0.0, 0.0;
  const CameraModel model(DistortionModel::kEquidistant, 120, 120, parameters);
  const auto motion =
      std::make_shared<SteadyMotion>(Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero());
  const auto room = NoisyRoom(false, 0.05);
  RenderOptions options = Clean(RenderQuality::kFast);
  const Renderer renderer(
      options, TrueCamera(ForwardRig(model), room,
                          std::make_shared<SteadyMotion>(Vector3d(0, 0, 1.5), Vector3d::Zero(),
                                                         Vector3d::Zero()),
                          kStart));
  const RenderedImage in_room = renderer.Render(0, kStart);
  EXPECT_EQ(in_room.image.at<std::uint8_t>(0, 0), 0);
  EXPECT_GT(in_room.image.at<std::uint8_t>(60, 60), 0);
  EXPECT_EQ(in_room.empty_share, 0.0);

  // A wall of 2 x 2 m at 2 m fills that share of the image.
  const CameraModel quarter = QuarterCamera(DistortionModel::kRadialTangential);
  const auto wall = Wall(2.0, 0.5, Texture(1, 1, 0.01, {100}));
  const Renderer few(options, TrueCamera(ForwardRig(quarter), wall, motion, kStart));
  const RenderedImage mostly_empty = few.Render(0, kStart);
  const double seen = 57.0 * 57.0 / (188.0 * 120.0);
  EXPECT_NEAR(mostly_empty.empty_share, 1.0 - seen, 0.02);
}

TEST(Renderer, SameBytesForAnyNumberOfThreads) {
  RigCalibration rig = ForwardRig(QuarterCamera(DistortionModel::kRadialTangential));
  rig.cameras.push_back(rig.cameras[0]);
  rig.cameras[1].p_CB.x() = -0.1;
  rig.t_r_s = 0.02;
  const auto room = NoisyRoom(true, 0.03);
  const auto motion = std::make_shared<SteadyMotion>(
      Vector3d(-1.5, 0.2, 1.5), Vector3d(0.3, 0.4, 0), Vector3d(0.1, 0.1, 0.8));
  RenderOptions options;
  options.exposure_s = 0.02;
  options.photometry.auto_exposure = true;
  options.photometry.gain_change = 0.2;
  for (const RenderQuality quality : {RenderQuality::kFast, RenderQuality::kAccurate}) {
    options.quality = quality;
    options.threads = 1;
    const Renderer one(options, TrueCamera(rig, room, motion, kStart));
    options.threads = 2;
    const Renderer two(options, TrueCamera(rig, room, motion, kStart));
    const Timestamp stamp = kStart + 300'000'000;
    const cv::Mat first = one.Render(0, stamp).image;
    (void)two.Render(1, stamp + 50'000'000);  // what came before does not matter
    for (const cv::Mat& again : {two.Render(0, stamp).image, one.Render(0, stamp).image}) {
      EXPECT_EQ(cv::norm(first, again, cv::NORM_INF), 0.0);
    }
    EXPECT_GT(cv::norm(first, one.Render(1, stamp).image, cv::NORM_INF), 0.0);
    EXPECT_GT(cv::norm(first, one.Render(0, stamp + 1).image, cv::NORM_INF), 0.0) << "noise";
  }
}

// Both qualities show the same scene.
TEST(Renderer, FastIsCloseToAccurate) {
  RigCalibration rig = ForwardRig(QuarterCamera(DistortionModel::kEquidistant));
  rig.t_r_s = 0.01;
  const auto room = NoisyRoom(true, 0.01);
  const auto motion = std::make_shared<SteadyMotion>(
      Vector3d(-1.5, 0.2, 1.5), Vector3d(0.3, 0.4, 0), Vector3d(0.1, 0.1, 0.5));
  RenderOptions options = Clean(RenderQuality::kFast);
  options.exposure_s = 0.01;
  const Renderer fast(options, TrueCamera(rig, room, motion, kStart));
  options.quality = RenderQuality::kAccurate;
  const Renderer accurate(options, TrueCamera(rig, room, motion, kStart));
  const cv::Mat a = fast.Render(0, kStart + 400'000'000).image;
  const cv::Mat b = accurate.Render(0, kStart + 400'000'000).image;
  EXPECT_LT(cv::norm(a, b, cv::NORM_L2) / std::sqrt(a.total()), 6.0);
  EXPECT_NEAR(cv::mean(a)[0], cv::mean(b)[0], 0.3);
}

}  // namespace
}  // namespace duet
