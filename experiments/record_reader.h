#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/dataset/ground_truth.h"
#include "evaluation/comparison.h"
#include "evaluation/consistency.h"
#include "experiments/child_process.h"
#include "experiments/manifest_reader.h"
#include "experiments/record_tables.h"

namespace duet {

/// What `duet run` has left in a folder, for a table; tables are made from records only. A folder
/// that is absent, because the program ended before it could write, gives a failed run with
/// `child`'s end as its reason. `span_start`: instants of failures count from here.
struct RunRecord {
  EstimatorRun run;
  std::vector<StampedPose> trajectory;
  std::string tracks_sha256;
};
[[nodiscard]] RunRecord ReadRunRecord(const std::filesystem::path& folder, const ChildResult& child,
                                      Timestamp span_start);

/// The part of it that its manifest.json tells. Throws InputError.
[[nodiscard]] RunRecord ReadRunManifest(const ManifestReader& manifest, Timestamp span_start);

/// What `duet track` has left, and the part of it that its manifest.json tells.
[[nodiscard]] FrontendRun ReadTrackRecord(const std::filesystem::path& folder);
[[nodiscard]] FrontendRun ReadTrackManifest(const ManifestReader& manifest);

/// The truth's pose interpolated; velocity and biases linear between its rows, zero where it has
/// none. Nothing outside of it and in its gaps.
[[nodiscard]] std::optional<InertialState> TruthStateAt(const GroundTruth& truth, Timestamp t);

/// NEES at each state of a record that has covariance.csv, against a truth with velocities.
[[nodiscard]] NeesRun ComputeRecordNees(const std::filesystem::path& folder,
                                        const GroundTruth& truth);
/// The same from tables in memory; a state without a covariance of its instant has no NEES.
[[nodiscard]] NeesRun ComputeNeesOfTables(const std::vector<InertialState>& states,
                                          const std::vector<RecordedCovariance>& covariances,
                                          const GroundTruth& truth);

}  // namespace duet
