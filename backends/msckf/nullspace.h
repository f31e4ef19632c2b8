#pragma once

#include <Eigen/Core>

namespace duet {

/// A stack of measurements: one row each, [H | r], the residual in the last column.
using MeasurementRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using MeasurementRowsRef = Eigen::Ref<MeasurementRows, 0, Eigen::OuterStride<>>;
using LandmarkRows = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using LandmarkRowsRef = Eigen::Ref<LandmarkRows, 0, Eigen::OuterStride<>>;

/// Projects a landmark out of its measurements (thesis 6.23): r = H x + H_f f + n with n white of
/// unit variance becomes A' r = A' H x + A' n, where the columns of A are an orthonormal basis of
/// the left null space of H_f (m x 3) and A' n is again white of unit variance.
///
/// Works in place by three Householder reflections, applied to the columns [first_column,
/// last_column) of `rows` and to its last column (the caller knows that the others are zero).
/// After it rows 3 .. m-1 of `rows` are the projected measurements; the first three rows and H_f
/// are used up (H_f holds its triangle above the reflections). m must be greater than 3.
void ProjectNullspace(LandmarkRowsRef H_f, MeasurementRowsRef rows, int first_column,
                      int last_column);

/// The same over all columns.
void ProjectNullspace(LandmarkRowsRef H_f, MeasurementRowsRef rows);

/// The same projection of what else has a row for each of the measurements, after ProjectNullspace
/// with what it left in `H_f`.
void ApplyProjection(const LandmarkRowsRef& H_f, MeasurementRowsRef rows);

}  // namespace duet
