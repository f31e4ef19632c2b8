#pragma once

#include <cstdint>
#include <memory>

#include "common/measurement/calibration.h"
#include "experiments/simulation/trajectory.h"
#include "experiments/simulation/world/world.h"

namespace duet {

/// Smooth seeded noise with structure from a few texels to a few hundred.
[[nodiscard]] Texture NoiseTexture(int width, int height, double texel_m, std::uint64_t seed);

/// Two grey levels: columns with u < edge_m are `low`, the others `high`.
[[nodiscard]] Texture StepTexture(double width_m, double height_m, double texel_m, double edge_m,
                                  std::uint8_t low, std::uint8_t high);

/// Walls of x, y in [-3, 3], z in [0, 3] with noise on them, looking inwards; `boxes`: three boxes
/// stand in it, and a fourth (body 1) goes to and fro.
[[nodiscard]] std::shared_ptr<const World> NoisyRoom(bool boxes, double texel_m = 0.006);

/// One wall in the plane x = distance_m, 2 `half_extent_m` wide and high around (y, z) = 0, looking
/// at the origin; u to the right as seen from there (-y), v downwards (-z).
[[nodiscard]] std::shared_ptr<World> Wall(double distance_m, double half_extent_m, Texture texture);

/// 188 x 120 px, f = 115 px: EuRoC's lens on a quarter of its pixels; or the same size by an
/// equidistant lens.
[[nodiscard]] CameraModel QuarterCamera(DistortionModel model);

/// One camera that looks along G's x where the body is at R_GB = I, its y and z along -y and -z.
[[nodiscard]] RigCalibration ForwardRig(const CameraModel& model);

/// Constant velocity, and a constant rate about a fixed axis: R_GB = Exp(t omega).
class SteadyMotion final : public Trajectory {
 public:
  SteadyMotion(const Eigen::Vector3d& p, const Eigen::Vector3d& v, const Eigen::Vector3d& omega)
      : p_(p), v_(v), omega_(omega) {}
  [[nodiscard]] double duration_s() const override { return 1e3; }
  [[nodiscard]] Kinematics At(double t_s) const override;

 private:
  Eigen::Vector3d p_, v_, omega_;
};

}  // namespace duet
