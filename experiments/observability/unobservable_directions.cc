#include "experiments/observability/unobservable_directions.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "common/support/numeric_text.h"

namespace duet {

WeakSpace::WeakSpace(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& prior_sigmas,
                     double least_ratio) {
  const Eigen::VectorXd scale = prior_sigmas.cwiseInverse();
  scaled_ = scale.asDiagonal() * covariance * scale.asDiagonal();
  basis_.resize(0, prior_sigmas.size());
  if (prior_sigmas.size() == 0) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled_);
  const Eigen::Index count = (solver.eigenvalues().array() > least_ratio * least_ratio).count();
  basis_ = solver.eigenvectors().rightCols(count).transpose();
  eigenvalues_ = solver.eigenvalues().tail(count);
}

Eigen::VectorXd WeakSpace::ComponentRatios() const {
  Eigen::VectorXd variances = Eigen::VectorXd::Zero(basis_.cols());
  for (Eigen::Index row = 0; row < basis_.rows(); ++row) {
    variances += eigenvalues_[row] * basis_.row(row).transpose().cwiseAbs2();
  }
  return variances.cwiseSqrt();
}

std::vector<CalibrationDirection> WeakSpace::Directions() const {
  // Largest pivot first: sparse where the space has a sparse basis.
  Eigen::MatrixXd basis = basis_;
  const Eigen::Index count = basis.rows();
  const Eigen::Index n = basis.cols();
  std::vector<bool> used(static_cast<std::size_t>(count), false);
  std::vector<Eigen::Index> row_of_pivot;
  for (Eigen::Index step = 0; step < count; ++step) {
    Eigen::Index pivot_row = -1;
    Eigen::Index pivot_column = 0;
    double largest = 0.0;
    for (Eigen::Index r = 0; r < count; ++r) {
      if (used[static_cast<std::size_t>(r)]) continue;
      for (Eigen::Index c = 0; c < n; ++c) {
        if (std::abs(basis(r, c)) > largest * (1.0 + 1e-9)) {
          largest = std::abs(basis(r, c));
          pivot_row = r;
          pivot_column = c;
        }
      }
    }
    if (pivot_row < 0) break;
    used[static_cast<std::size_t>(pivot_row)] = true;
    row_of_pivot.push_back(pivot_row);
    basis.row(pivot_row) /= basis(pivot_row, pivot_column);
    for (Eigen::Index r = 0; r < count; ++r) {
      if (r != pivot_row) basis.row(r) -= basis(r, pivot_column) * basis.row(pivot_row);
    }
  }

  std::vector<CalibrationDirection> directions;
  for (const Eigen::Index row : row_of_pivot) {
    Eigen::VectorXd v = basis.row(row).transpose();
    Eigen::Index largest = 0;
    v.cwiseAbs().maxCoeff(&largest);
    v /= v[largest];
    CalibrationDirection direction;
    direction.ratio = std::sqrt(v.dot(scaled_ * v) / v.squaredNorm());
    for (Eigen::Index c = 0; c < n; ++c) {
      if (std::abs(v[c]) >= kSmallestTerm) {
        direction.terms.push_back({static_cast<int>(c), v[c]});
      }
    }
    // Equal but for rounding: in the order of the components.
    const auto rank = [](const auto& term) { return std::round(1e6 * std::abs(term.coefficient)); };
    std::stable_sort(direction.terms.begin(), direction.terms.end(),
                     [&](const auto& a, const auto& b) { return rank(a) > rank(b); });
    directions.push_back(std::move(direction));
  }
  std::stable_sort(directions.begin(), directions.end(), [](const auto& a, const auto& b) {
    if (a.terms.size() != b.terms.size()) return a.terms.size() < b.terms.size();
    return a.terms.front().component < b.terms.front().component;
  });
  return directions;
}

std::string DirectionText(const CalibrationDirection& direction,
                          const std::vector<std::string>& names) {
  std::string text;
  for (const CalibrationDirection::Term& term : direction.terms) {
    const double size = std::abs(term.coefficient);
    text += term.coefficient < 0.0 ? (text.empty() ? "-" : " - ") : (text.empty() ? "" : " + ");
    if (std::abs(size - 1.0) > 0.05) text += FormatFixed(size, 1) + " ";
    text += names[static_cast<std::size_t>(term.component)];
  }
  return text;
}

}  // namespace duet
