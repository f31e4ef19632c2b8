#include "test/backends/window/random_window.h"

#include <cmath>

#include "backends/window/imu_factor.h"
#include "common/geometry/so3.h"
#include "common/support/logging.h"

namespace duet::window_test {
namespace {

constexpr Timestamp kStart = 1'400'000'000'000'000'000;
constexpr double kImuRate_hz = 200.0;

RigCalibration RandomRig(Random* random) {
  RigCalibration rig;
  for (int c = 0; c < 2; ++c) {
    CameraCalibration camera;
    CameraModel::Parameters parameters(9);
    parameters << 458.0 + c, 457.0, 367.0, 248.0 + c, -0.28, 0.07, 2e-4, -1e-4, 0.005;
    camera.model = CameraModel(DistortionModel::kRadialTangential, 752, 480, parameters);
    camera.R_CB = ExpQuaternion(RandomVector(random, 0.1));
    camera.p_CB = Eigen::Vector3d(-0.11 * c, 0.02, -0.01) + RandomVector(random, 0.01);
    rig.cameras.push_back(camera);
  }
  rig.imu.T_g += 0.02 * Eigen::Matrix3d::NullaryExpr([&]() { return random->Normal(); });
  rig.imu.T_s += 0.001 * Eigen::Matrix3d::NullaryExpr([&]() { return random->Normal(); });
  rig.imu.T_a += 0.02 * Eigen::Matrix3d::NullaryExpr([&]() { return random->Normal(); });
  rig.t_d_s = 0.003;
  rig.t_r_s = 0.02;
  return rig;
}

// A rig that turns and accelerates in all axes, upright on average: its camera looks along z.
void AddMotion(double duration_s, Random* random, ImuBuffer* imu) {
  const Eigen::Vector3d rate = RandomVector(random, 0.3);
  const Eigen::Vector3d phase = RandomVector(random, 3.0);
  for (int i = -20; i < duration_s * kImuRate_hz + 20; ++i) {
    const double t = i / kImuRate_hz;
    ImuSample sample;
    sample.timestamp = kStart + ToNanoseconds(t);
    for (int k = 0; k < 3; ++k) {
      sample.omega_m[k] = rate[k] * std::cos(3.0 * t + phase[k]);
      sample.a_m[k] = (k == 2 ? 9.81 : 0.0) + 2.0 * std::sin(5.0 * t + phase[k]);
    }
    imu->Add(sample);
  }
}

}  // namespace

Eigen::Vector3d RandomVector(Random* random, double sigma) {
  return sigma * random->NormalVector<3>();
}

ImuNoise EurocNoise() { return {1.7e-4, 2e-3, 2e-5, 3e-3}; }

CalibrationPriors EverythingEstimated() {
  CalibrationPriors priors;
  priors.T_g.estimated = priors.T_s.estimated = priors.T_a.estimated = true;
  priors.p_CB.estimated = priors.R_CB.estimated = true;
  priors.intrinsics.estimated = priors.distortion.estimated = true;
  priors.t_d.estimated = priors.t_r.estimated = true;
  return priors;
}

RandomWindow::RandomWindow(int frame_count, int landmark_count, std::uint64_t seed) {
  Random random(seed);
  rig = RandomRig(&random);
  layout = CalibrationLayout(EverythingEstimated(), rig);
  reprojection.g_G = Eigen::Vector3d(0, 0, -9.81);
  reprojection.pixel_noise_px = 1.3;
  reprojection.off_instant = true;
  AddMotion(kFrameInterval_s * frame_count, &random, &imu);

  for (int i = 0; i < frame_count; ++i) {
    WindowFrame frame;
    frame.state.instant = kStart + i * ToNanoseconds(kFrameInterval_s);
    frame.t_d_at_instant_s = rig.t_d_s - 0.001 * random.Normal();
    frame.state.biases = {RandomVector(&random, 0.01), RandomVector(&random, 0.1)};
    if (i == 0) {
      frame.state.nav = {ExpQuaternion(RandomVector(&random, 0.1)), RandomVector(&random, 2.0),
                         RandomVector(&random, 0.3)};
    } else {
      const InertialState& before = frames.back().state;
      std::vector<ImuSample> readings;
      imu.Extract(before.instant, frame.state.instant, &readings);
      ImuLink link;
      link.delta = IntegrateImu(readings, before.biases, rig.imu, EurocNoise());
      link.sqrt_information = SquareRootInformation(link.delta.covariance);
      frame.state.nav = Predict(before.nav, link.delta, reprojection.g_G);
      frame.link = link;
    }
    frame.rates.Assign(imu, frame.state.instant, 0.04, frame.state.biases, rig.imu);
    frames.push_back(std::move(frame));
  }
  const auto truth = frames;
  for (int l = 0; l < landmark_count; ++l) {
    Landmark landmark;
    landmark.track_id = l;
    landmark.has_value = landmark.in_problem = true;
    landmark.seen_newest = true;
    landmark.value = {random.Uniform(-0.4, 0.4), random.Uniform(-0.3, 0.3),
                      1.0 / random.Uniform(2.0, 8.0)};
    const int anchor = random.UniformInt(frame_count - 1);
    for (int f = anchor; f < frame_count; ++f) {
      for (int c = 0; c < 2; ++c) {
        const ObservingState state{truth[f].state.nav, truth[f].t_d_at_instant_s, &truth[f].rates};
        PixelObservation pixel{c, Eigen::Vector2d(376, 240)};
        CHECK(PredictPixel(rig, truth[anchor].state.nav.pose(), landmark.value, state, pixel,
                           reprojection.g_G, &pixel.uv));
        pixel.uv += random.NormalVector<2>();
        landmark.observations.push_back({f, pixel});
      }
    }
    landmark.value += Eigen::Vector3d(1e-3, -1e-3, 2e-3);
    landmarks.push_back(std::move(landmark));
  }
  for (WindowFrame& frame : frames) {
    Vector15d error;
    error << RandomVector(&random, 0.01), RandomVector(&random, 0.01), RandomVector(&random, 0.02),
        RandomVector(&random, 1e-3), RandomVector(&random, 1e-2);
    frame.state = BoxPlus(frame.state, error);
  }
}

WindowPoint RandomWindow::Point() const {
  WindowPoint point;
  for (const WindowFrame& frame : frames) {
    point.nav.push_back(frame.state.nav);
    point.biases.push_back(frame.state.biases);
  }
  point.rig = rig;
  return point;
}

}  // namespace duet::window_test
