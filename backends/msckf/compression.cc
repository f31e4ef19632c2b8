#include "backends/msckf/compression.h"

#include <Eigen/QR>

namespace duet {

int Compress(Eigen::Ref<Eigen::MatrixXd> stack) {
  const auto columns = stack.cols() - 1;
  if (stack.rows() <= columns) return static_cast<int>(stack.rows());
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> in_place(stack);
  stack.topLeftCorner(columns, columns).triangularView<Eigen::StrictlyLower>().setZero();
  return static_cast<int>(columns);
}

}  // namespace duet
