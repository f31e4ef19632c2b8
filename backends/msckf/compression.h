#pragma once

#include <Eigen/Core>

namespace duet {

/// Compresses a stack of measurements [H | r] with white noise of unit variance (thesis 6.30 to
/// 6.32): H = Q1 T_H, so Q1' r = T_H x + Q1' n says all that the stack says of x. In place, by
/// Householder reflections; allocates two vectors of the stack's width.
///
/// Returns the number of rows that remain at the top of `stack`: as many as H has columns, and the
/// stack as it was where it has no more rows than that. T_H is upper triangular; what is below its
/// diagonal is set to zero.
[[nodiscard]] int Compress(Eigen::Ref<Eigen::MatrixXd> stack);

}  // namespace duet
