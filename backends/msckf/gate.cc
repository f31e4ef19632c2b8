#include "backends/msckf/gate.h"

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <limits>

#include "common/support/logging.h"

namespace duet {

ChiSquaredGate::ChiSquaredGate(double probability, int max_degrees_of_freedom) {
  CHECK_GT(max_degrees_of_freedom, 0);
  thresholds_.reserve(max_degrees_of_freedom);
  for (int k = 1; k <= max_degrees_of_freedom; ++k) {
    thresholds_.push_back(
        boost::math::quantile(boost::math::chi_squared_distribution<double>(k), probability));
  }
}

double ChiSquaredGate::Threshold(int degrees_of_freedom) const {
  CHECK_GE(degrees_of_freedom, 1);
  CHECK_LE(degrees_of_freedom, static_cast<int>(thresholds_.size()));
  return thresholds_[degrees_of_freedom - 1];
}

double ChiSquaredGate::Distance(const Eigen::Ref<const Eigen::VectorXd>& r) {
  const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(S_);
  if (llt.info() != Eigen::Success) return std::numeric_limits<double>::infinity();
  y_ = r;
  llt.matrixL().solveInPlace(y_);
  return y_.squaredNorm();
}

}  // namespace duet
