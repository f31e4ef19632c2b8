#pragma once

#include <Eigen/Core>
#include <vector>

#include "backends/window/imu_factor.h"
#include "common/measurement/calibration.h"
#include "common/measurement/standstill.h"

namespace duet {

/// A pixel's whitened Jacobians; the landmark's three numbers are those of a point that is fixed in
/// G, in coordinates that stay the same as long as the landmark is open.
struct PixelJacobians {
  Eigen::Matrix<double, 2, 3> landmark;
  Eigen::Matrix<double, 2, 9> state;  ///< theta, p, v of the newest frame
  Eigen::Matrix<double, 2, Eigen::Dynamic> calibration;
};

/// The Fisher information of a recording, frame by frame, at given linearization points: the sum of
/// all J'J over
///
///   newest frame (theta, p, v, b_g, b_a) | calibration | open landmarks, 3 each
///
/// with everything older eliminated (the marginal of a Gaussian, by Schur complements): a frame as
/// soon as the IMU has joined the next one to it, a landmark when it is closed. As landmarks are
/// points in G, no older frame is needed for them, however long their tracks; the size is that of
/// one frame, not of a track. Changing a point's coordinates (to those of an anchor frame, say) is
/// a linear change of variables at one linearization point and leaves the rest's information as it
/// is, so this is exactly the information of the batch problem.
class InformationFilter {
 public:
  /// `prior`: information of frame 0 and the calibration, (15 + layout.size()) squared.
  InformationFilter(const CalibrationLayout& layout, const Eigen::MatrixXd& prior);

  /// A new landmark; the number stands for it until it is closed.
  [[nodiscard]] int OpenLandmark();
  /// A pixel of an open landmark in the newest frame.
  void AddPixel(int landmark, const PixelJacobians& J);
  /// Eliminates the landmark; directions that its pixels say nothing of are left out by the rank
  /// rule of backends/window/marginalization.h.
  void CloseLandmark(int landmark);

  /// Joins the next frame by the whitened IMU factor and, where `rest` is not null, the standstill
  /// measurement, and eliminates the frame before.
  void Propagate(const ImuFactorJacobians& J, const StandstillResidual* rest);

  /// The covariance of the newest frame and the calibration, open landmarks eliminated in a copy.
  /// Empty where the information is not positive definite in double precision.
  [[nodiscard]] Eigen::MatrixXd Covariance() const;

 private:
  [[nodiscard]] Eigen::Index Column(int slot) const { return fixed_ + 3 * slot; }
  [[nodiscard]] Eigen::Index size() const { return Column(static_cast<int>(owner_.size())); }

  const CalibrationLayout* layout_;
  Eigen::Index fixed_;      ///< components before the landmarks
  Eigen::MatrixXd H_;       ///< symmetric; the top left size() x size() is in use
  std::vector<int> slot_;   ///< of a landmark's number; -1: free
  std::vector<int> owner_;  ///< of a slot
  std::vector<int> free_;   ///< numbers to use again
  Eigen::MatrixXd scratch_;
};

}  // namespace duet
