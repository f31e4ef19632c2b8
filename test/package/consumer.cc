#include <cstdio>

#include "backends/factory.h"

int main() {
  duet::EstimatorSetup setup;
  duet::CameraModel::Parameters parameters(9);
  parameters << 458.0, 457.0, 367.0, 248.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  setup.rig.cameras.push_back(
      {duet::CameraModel(duet::DistortionModel::kRadialTangential, 752, 480, parameters), {}, {}});
  setup.rig.cameras[0].R_CB.setIdentity();
  setup.rig.cameras[0].p_CB.setZero();
  setup.imu_noise = {1.7e-4, 2e-3, 1.9e-5, 3e-3};
  for (const std::string& name : duet::EstimatorNames()) {
    const auto estimator = duet::MakeEstimator(name, setup, {});
    std::printf("%s estimates %d calibration numbers\n", name.c_str(), estimator->layout().size());
  }
  return 0;
}
