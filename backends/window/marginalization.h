#pragma once

#include <Eigen/Core>
#include <span>

namespace duet {

/// A quadratic 1/2 x' H x + b' x (+ constant) over a vector of errors x: what linearized residuals
/// r + J x add up to, with H = J'J and b = J'r.
struct InformationForm {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
};

/// The same quadratic as the residual J x + e: H = J'J and b = J'e. J has as many rows as H has
/// rank.
struct SquareRootForm {
  Eigen::MatrixXd J;
  Eigen::VectorXd e;
};

/// The rank rule: after scaling to a unit diagonal, what is left on the diagonal by elimination in
/// order of the largest remaining pivot counts as information while it exceeds this. Rounding in a
/// sum of J'J leaves about n * 2^-52; a direction known a million times worse than its neighbours
/// leaves 1e-12.
inline constexpr double kRankTolerance = 1e-13;

/// Minimizes over the `drop` components of x and leaves the quadratic over the `keep` components,
/// in their order:
///
///   H* = H_kk - H_kd H_dd^+ H_dk,   b* = b_k - H_kd H_dd^+ b_d
///
/// This is the marginal of a Gaussian. Both lists together need not be all of x: components that
/// are in neither are held at zero (conditioned on).
[[nodiscard]] InformationForm SchurComplement(const InformationForm& form,
                                              std::span<const int> keep, std::span<const int> drop);

/// By Cholesky's method with complete diagonal pivoting and the rank rule. H must be positive
/// semidefinite up to rounding.
[[nodiscard]] SquareRootForm TakeSquareRoot(const InformationForm& form);

}  // namespace duet
