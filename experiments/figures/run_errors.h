#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/ground_truth.h"
#include "common/dataset/recording.h"
#include "evaluation/alignment.h"
#include "evaluation/consistency.h"
#include "experiments/figures/figure_runs.h"

namespace duet {

/// A table of a record whose first column is a stamp: fields that are empty or no numbers are NaN.
struct RecordTable {
  std::vector<std::string> names;  ///< of all columns but the first, with their units
  std::vector<Timestamp> stamps;
  std::vector<std::vector<double>> columns;

  /// Nothing where there is no column of this name.
  [[nodiscard]] const std::vector<double>* Find(const std::string& name) const;
};
[[nodiscard]] RecordTable ReadRecordTable(const std::filesystem::path& file);
/// The same from its text; `file` is for errors. Throws InputError.
[[nodiscard]] RecordTable ParseRecordTable(std::string_view csv, const std::string& file);

/// The truth at least at the instants of a run's states, in the estimator's axes: the record's
/// truth.csv, else that of the recording which the manifest names. Throws InputError where there is
/// none, or where the recording is no longer the one that was run on.
[[nodiscard]] GroundTruth TruthOf(const FigureRun& run);
/// The recording that a run's manifest names (of a study: the folder's own), with the tracks that
/// were run on.
[[nodiscard]] Recording RecordingOf(const FigureRun& run);
/// The estimate; empty where the run had no state.
[[nodiscard]] std::vector<StampedPose> TrajectoryOf(const FigureRun& run);

/// x_G = R_GE x_E + p_GE by `mode`; where the path does not determine that (it stands still), the
/// yaw is fitted to the orientations and the first positions are laid onto one another, and
/// `by_first` says so. `pairs` must not be empty.
[[nodiscard]] Alignment AlignOrFirst(const std::vector<PosePair>& pairs, AlignmentMode mode,
                                     bool* by_first);

/// True minus estimate over time, with the standard deviations that the estimator gave itself, in
/// G.
struct ErrorsOverTime {
  std::vector<double> t_s;  ///< after the first frame
  std::array<std::vector<double>, 3> theta_deg, p_m;
  std::array<std::vector<double>, 3> sigma_theta_deg, sigma_p_m;
  /// The estimate was laid onto the truth by position and yaw before, since it did not start in the
  /// truth's axes; its standard deviations count from its own start.
  bool aligned = false;
  bool by_first = false;  ///< AlignOrFirst's
};
/// Throws InputError that says how to run where the record has no covariance.csv.
[[nodiscard]] ErrorsOverTime ErrorsOf(const FigureRun& run);

/// NEES over the states of a run, stamped with the frames' stamps (the same for all runs on one
/// stream, whatever time offset they estimate). Throws InputError as ErrorsOf does, and for a run
/// that did not start in the truth's axes.
[[nodiscard]] NeesRun NeesOf(const FigureRun& run);

/// Errors after position + yaw alignment, each after its own fit: those of the study's
/// evaluation.json, else by the same definition from trajectory and truth. NaN where there is none.
struct RunRmse {
  double position_m = std::nan("");
  double orientation_deg = std::nan("");
};
[[nodiscard]] RunRmse RmseOf(const FigureRun& run);

}  // namespace duet
