#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/dataset/recording.h"
#include "experiments/study/study_plan.h"

namespace duet {

/// What stream.json says of a stream of a study's folder.
struct StudyStreamInfo {
  std::string id;
  std::string determined_by;
  /// Its truth is the simulator's own: NEES and errors of the calibration can be claimed.
  bool simulated = false;
  std::string tracks_sha256;
};

/// streams/<id> of the folder.
[[nodiscard]] std::filesystem::path StreamFolder(const std::filesystem::path& study_folder,
                                                 const std::string& id);

/// Simulates or tracks the stream into the study's folder, complete or not at all, unless it is
/// there. Of several processes that make it, one's is kept; those of one machine wait for the
/// first. False where the program was interrupted. Throws InputError and OutputError.
[[nodiscard]] bool EnsureStream(const StudyPlan& plan, const PlannedStream& stream,
                                const std::filesystem::path& study_folder);

/// The numbers of the cameras that have tracks in it.
[[nodiscard]] std::vector<int> CamerasOfStream(const std::filesystem::path& stream_folder);

[[nodiscard]] StudyStreamInfo ReadStreamInfo(const std::filesystem::path& stream_folder);

}  // namespace duet
