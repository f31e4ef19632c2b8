#pragma once

#include <Eigen/Core>
#include <span>

#include "backends/window/imu_factor.h"
#include "backends/window/marginalization.h"
#include "backends/window/prior.h"
#include "backends/window/reprojection_factor.h"
#include "backends/window/window_state.h"
#include "common/measurement/standstill.h"

namespace duet {

/// One observation, linearized: whitened, robust weight included, J_x at the linearization point, r
/// at the current one.
struct LinearObservation {
  int frame = 0;
  Eigen::Vector2d r;
  ReprojectionJacobians J;
};

/// L^-1 with L L' = V of a landmark (3 x 3), by Cholesky in the order alpha, beta, rho; directions
/// without information, by the rank rule of marginalization.h, get no pivot (a row of zeros).
[[nodiscard]] Eigen::Matrix3d LandmarkInverseCholesky(const Eigen::Matrix3d& V);

/// How a landmark's inverse depth, the minimum over its pixels, follows the rest of the window's
/// error x (frames, then calibration): diagonal * rho = - row . x + noise of unit variance.
/// Diagonal 0 where the pixels say nothing of the depth.
struct DepthRow {
  double diagonal = 0.0;
  Eigen::VectorXd row;
};
void LinearizeDepth(int anchor, std::span<const LinearObservation> observations, int frame_count,
                    const CalibrationLayout& layout, DepthRow* depth);

/// H = sum of J'J and b = sum of J'r over the window's error, landmarks eliminated on the way in:
///
///            frame 0 | frame 1 | ... | calibration
///   H =    [ IMU + standstill: block tridiagonal + calibration's rows and columns  ]
///        + [ landmarks: dense over the frames that saw them                        ]
///
/// This is what marginalization and the covariance are made from. The solver has its own.
class NormalEquations {
 public:
  NormalEquations(int frame_count, const CalibrationLayout& layout);

  /// r and J whitened. Frame j follows frame i.
  void AddImu(int i, int j, const Vector15d& r, const ImuFactorJacobians& J);
  void AddStandstill(int i, int j, const StandstillResidual& residual);

  /// Eliminates the landmark (its minimum over alpha, beta, rho; over rho alone where
  /// `inverse_depth_only`) and adds what its observations say of the rest. Directions of the
  /// landmark that they say nothing of are left out by the rank rule of marginalization.h.
  void AddLandmark(int anchor, std::span<const LinearObservation> observations, bool velocities,
                   bool inverse_depth_only);

  /// Adds what a prior says.
  void AddPrior(const WindowPrior& prior);

  /// The sum so far, its upper triangle.
  [[nodiscard]] const Eigen::MatrixXd& H() const { return sum_.H; }
  /// The whole quadratic, symmetric.
  [[nodiscard]] InformationForm Take();

 private:
  template <int kSize>
  void AddLandmarkOf(int anchor, std::span<const LinearObservation> observations,
                     bool inverse_depth_only);

  const CalibrationLayout* layout_;
  int frame_count_;
  int calibration_;           ///< its first component
  InformationForm sum_;       ///< upper triangle
  Eigen::MatrixXd pixels_;    ///< scratch
  Eigen::MatrixXd products_;  ///< scratch
};

}  // namespace duet
