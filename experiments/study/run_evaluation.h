#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/dataset/recording.h"

namespace duet {

using NamedNumbers = std::vector<std::pair<std::string, double>>;

/// What came of one run, from its record and the recording that it ran on; nothing else enters, so
/// that the same can be derived again at any time.
struct RunEvaluation {
  bool failed = false;
  std::string reason;
  /// By the keys of docs/formats.md; what does not exist is left out.
  NamedNumbers metrics;
  /// Why something is left out: key (or what all keys begin with) and reason.
  std::vector<std::pair<std::string, std::string>> left_out;
  /// The truth at the states' instants in the estimator's axes; instants without one are left out.
  GroundTruth truth;
  /// The true value of each number of the calibration that was estimated, in the estimator's axes;
  /// empty where it is not known.
  NamedNumbers calibration_truth;
};

/// `recording`: the whole recording of the stream. `simulated`: its truth and its calibration are
/// exact, so that NEES, errors without alignment and errors of the calibration can be claimed.
/// Throws InputError where the record is none.
[[nodiscard]] RunEvaluation EvaluateRecord(const std::filesystem::path& record,
                                           const Recording& recording, bool simulated);

/// Time a frame and memory, from timing.csv and manifest.json of a record.
[[nodiscard]] NamedNumbers CostOfRecord(const std::filesystem::path& record);

/// The files of a record that are made of it (docs/formats.md): names and texts.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> EvaluationTexts(
    const RunEvaluation& evaluation);
/// Throws OutputError.
void WriteRunEvaluation(const RunEvaluation& evaluation, const std::filesystem::path& record);

/// What an evaluation.json says; its truths are not read. Throws InputError.
[[nodiscard]] RunEvaluation ReadEvaluation(const std::filesystem::path& record);
/// The same from its text; `file` is for errors.
[[nodiscard]] RunEvaluation ParseEvaluation(std::string_view text, const std::string& file);

}  // namespace duet
