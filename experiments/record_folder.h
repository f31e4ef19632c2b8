#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/config/config_sources.h"
#include "common/dataset/recording.h"
#include "common/support/output_folder.h"
#include "experiments/live_tracker.h"
#include "experiments/log_capture.h"
#include "experiments/manifest.h"

namespace duet {

/// Refuses an --out that is there already, before any work is done: InputError.
void RequireAbsent(const std::string& out);

/// A folder of results, complete or absent: what all of them hold (manifest.json, config.yaml,
/// log.txt) is written by Commit().
class RecordFolder {
 public:
  RecordFolder(const std::string& out, const std::string& command_line, const LogCapture& log,
               OutputFolder::Makers makers = OutputFolder::Makers::kOne);

  /// Where files go until Commit().
  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }
  [[nodiscard]] const std::filesystem::path& target() const { return folder_.target(); }
  [[nodiscard]] Manifest& manifest() { return manifest_; }

  /// Writes what is left and puts the folder into its place. Throws OutputError.
  void Commit(const ConfigSources& sources);

  /// The two halves of Commit, for who computes something from what is written, or puts the folder
  /// into its place otherwise.
  void WriteRest(const ConfigSources& sources);
  [[nodiscard]] OutputFolder& folder() { return folder_; }

 private:
  const LogCapture& log_;
  Manifest manifest_;
  OutputFolder folder_;
};

/// What the manifest says of the recording.
[[nodiscard]] Manifest DescribeRecording(const Recording& recording);
/// What the manifest says of the front end's work.
[[nodiscard]] Manifest DescribeTracking(const LiveTracker& tracker,
                                        const std::vector<TrackFrameSet>& frames);

/// Writes tracks<k>/ of the recording's cameras and tracks.sha256 into the folder; returns the
/// hash. What is written replays to exactly `frames`.
std::string WriteTracks(const std::filesystem::path& folder, const Recording& recording,
                        const std::vector<TrackFrameSet>& frames,
                        const std::vector<ResolvedValue>& settings);

}  // namespace duet
