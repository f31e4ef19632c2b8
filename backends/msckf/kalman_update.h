#pragma once

#include <Eigen/Core>
#include <span>

namespace duet {

/// Memory that KalmanUpdate reuses from call to call.
struct KalmanWorkspace {
  Eigen::MatrixXd P_columns;  ///< P at the measured components, n x width
  Eigen::MatrixXd P_H;        ///< P H', then P H' L'^-1
  Eigen::MatrixXd measured;   ///< rows of P H' at the measured components
  Eigen::MatrixXd S;
  Eigen::VectorXd y;
};

/// What is known of the zeros of a stack's H.
enum class MeasurementShape {
  kFull,
  kUpperTriangular,  ///< square and upper triangular, as Compress leaves it
};

/// The update of thesis 6.29 and 6.33 with measurements [H | r] of unit noise:
///
///   S = H P H' + I = L L',  W = P H' L'^-1,  dx = W L^-1 r,  P <- P - W W'
///
/// which is (I - K H) P (I - K H)' + K K' in exact arithmetic (tested), symmetric by construction,
/// and a third of its work. `columns[j]` is the component of the state that column j of H acts on;
/// no other component is measured. P (n x n) and dx (n) are written only on success; false where S
/// is not positive definite, that is where P was none.
[[nodiscard]] bool KalmanUpdate(const Eigen::Ref<const Eigen::MatrixXd>& H_r,
                                std::span<const int> columns, Eigen::Ref<Eigen::MatrixXd> P,
                                Eigen::Ref<Eigen::VectorXd> dx, KalmanWorkspace* workspace,
                                MeasurementShape shape = MeasurementShape::kFull);

/// The same where P H' is known: the caller has put it into workspace->P_H (n x rows), which is
/// used up.
[[nodiscard]] bool KalmanUpdateOfKnownProduct(const Eigen::Ref<const Eigen::MatrixXd>& H_r,
                                              std::span<const int> columns,
                                              Eigen::Ref<Eigen::MatrixXd> P,
                                              Eigen::Ref<Eigen::VectorXd> dx,
                                              KalmanWorkspace* workspace,
                                              MeasurementShape shape = MeasurementShape::kFull);

}  // namespace duet
