#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/imu/nav_state.h"

namespace duet {

/// The tables of a run record that numbers are made from (docs/formats.md). All throw InputError.

/// states.csv: instants, states and biases; stamps increase. The calibration and the standard
/// deviations are passed over. Empty where the run had no state.
[[nodiscard]] std::vector<InertialState> ReadStateTable(std::string_view csv,
                                                        const std::string& file);

/// A row of covariance.csv: of theta, p, v, b_g, b_a; the calibration's part is left out. Numbers
/// that are not finite are kept: they are what the estimator said, and have no NEES.
struct RecordedCovariance {
  Timestamp instant = 0;
  Matrix15d covariance = Matrix15d::Zero();
};
[[nodiscard]] std::vector<RecordedCovariance> ReadCovarianceTable(std::string_view csv,
                                                                  const std::string& file);

/// The whole of the last row's covariance, with the calibration's part; empty where there is no
/// row.
[[nodiscard]] Eigen::MatrixXd ReadLastCovariance(std::string_view csv, const std::string& file);

/// Mean over the frames of a column of features.csv; NaN where there was no frame.
[[nodiscard]] double ReadFeatureMean(std::string_view csv, const std::string& file,
                                     const std::string& column);

/// Mean time [s] between the oldest and the newest frame of an estimator's window that holds up to
/// `frames`, from features.csv: each frame comes to the window; where the one before it stays
/// (`keyframe`) the oldest goes once the window is full, else the one before. The mean is over
/// frames whose window is full; NaN where it never was. Frames without an estimate are passed over.
[[nodiscard]] double ReadWindowSpan(std::string_view csv, const std::string& file, int frames);

}  // namespace duet
