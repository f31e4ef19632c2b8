#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "backends/estimator.h"
#include "common/support/text_file.h"
#include "experiments/calibration_watch.h"

namespace duet {

/// How an estimator's run went, for the manifest and the program's last line.
struct RunSummary {
  int frames = 0;   ///< fed
  int waiting = 0;  ///< before the start
  /// From the first frame to the one with the first state; to the last one where there is none.
  double waited_s = 0.0;
  int tracking = 0;
  int dead_reckoning = 0;
  int skipped = 0;  ///< their interval was not covered by the IMU
  EstimatorStatus last_status = EstimatorStatus::kInitializing;
  std::optional<Timestamp> first_instant;  ///< of the states written
  std::optional<Timestamp> last_instant;
  std::string failure;  ///< empty: it did not fail
  std::optional<Timestamp> failure_instant;
};

/// Writes what an estimator says, frame by frame, into a folder (docs/formats.md):
/// trajectory.tum, states.csv, features.csv, where something is estimated calibration.csv
/// and, when asked, covariance.csv. All are canonical: the
/// same bytes for the same input.
class RunRecorder {
 public:
  /// `told`: the rig that the estimator was told.
  RunRecorder(const std::filesystem::path& folder, const CalibrationLayout& layout,
              const RigCalibration& told, const TimeBounds& bounds, bool with_covariance);

  /// A frame that came before the start.
  void AddWaiting(const TrackFrameSet& frames);
  void Add(const TrackFrameSet& frames, const EstimatorOutput& output);
  /// Throws OutputError where something could not be written.
  void Close();

  [[nodiscard]] const RunSummary& summary() const { return summary_; }
  /// What became of the estimated calibration; empty where nothing is estimated.
  [[nodiscard]] const CalibrationWatch& calibration() const { return calibration_; }

 private:
  void CountFrame(const TrackFrameSet& frames);
  void AddState(const EstimatorOutput& output);
  void AddCovariance(const EstimatorOutput& output);
  void AddFeatures(const TrackFrameSet& frames, const char* status, const FeatureCounts& counts);

  std::filesystem::path folder_;
  CalibrationLayout layout_;
  CalibrationWatch calibration_;
  TextFileWriter trajectory_;
  TextFileWriter states_;
  TextFileWriter features_;
  std::optional<TextFileWriter> covariance_;
  RunSummary summary_;
  Timestamp first_frame_ = 0;
  std::string row_;
};

}  // namespace duet
