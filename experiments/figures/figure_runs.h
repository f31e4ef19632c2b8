#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/dataset/ground_truth.h"
#include "common/dataset/recording.h"
#include "evaluation/alignment.h"
#include "evaluation/consistency.h"
#include "evaluation/study_result.h"

namespace duet {

/// One run record that a figure may be made from.
struct FigureRun {
  std::filesystem::path folder;  ///< of the record
  std::filesystem::path study;   ///< the folder of the study that it is of; empty: none
  StudyRun where;                ///< metrics are not filled in; plain records: docs/figures.md
  /// For legends: the estimator, and every further coordinate in which the runs found differ.
  std::string label;
};

/// The run records in folders that may be studies (runs/<id>), of `duet compare` (one folder an
/// estimator) or of one run, in their order; runs that failed too. Throws InputError for a folder
/// that is none of these, naming what it expected.
[[nodiscard]] std::vector<FigureRun> FindRuns(const std::vector<std::filesystem::path>& folders);

/// What a figure over time shows of many: the runs on the same stream, setting, perturbation and
/// seed as the first; of plain records those on the first one's recording. Runs that failed are in
/// it as far as they went. At most six.
[[nodiscard]] std::vector<FigureRun> ExampleRuns(const std::vector<FigureRun>& runs);

/// The runs that are on the first one's stream, setting and perturbation, whatever their seed.
[[nodiscard]] std::vector<FigureRun> RunsOfFirstGroup(const std::vector<FigureRun>& runs);

/// Estimators in the order of their first runs.
[[nodiscard]] std::vector<std::string> EstimatorsOf(const std::vector<FigureRun>& runs);

/// manifest.json, or another JSON file of a record. Throws InputError.
[[nodiscard]] nlohmann::ordered_json ReadJsonFile(const std::filesystem::path& file);

/// A table of a record whose first column is a stamp: fields that are empty or no numbers are NaN.
struct RecordTable {
  std::vector<std::string> names;  ///< of all columns but the first, with their units
  std::vector<Timestamp> stamps;
  std::vector<std::vector<double>> columns;

  /// Nothing where there is no column of this name.
  [[nodiscard]] const std::vector<double>* Find(const std::string& name) const;
};
[[nodiscard]] RecordTable ReadRecordTable(const std::filesystem::path& file);

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

/// For the files' comments: path, program's version and commit, tracks.
[[nodiscard]] std::string DescribeSource(const FigureRun& run);
[[nodiscard]] std::vector<std::string> DescribeSources(const std::vector<FigureRun>& runs);

}  // namespace duet
