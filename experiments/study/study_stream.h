#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
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
  /// SHA-256 of every other file of the stream (IMU, truth, calibration, tracks), by its path.
  std::map<std::string, std::string> files;
};

/// streams/<id> of the folder.
[[nodiscard]] std::filesystem::path StreamFolder(const std::filesystem::path& study_folder,
                                                 const std::string& id);

/// Simulates or tracks the stream into the study's folder, complete or not at all, unless it is
/// there. Of several processes that make it, one's is kept; those of one machine wait for the
/// first. One that is there must be what was written: files that are missing, changed or new are an
/// error, as no run on them would be what its id says. False where the program was interrupted.
/// Throws InputError and OutputError.
[[nodiscard]] bool EnsureStream(const StudyPlan& plan, const PlannedStream& stream,
                                const std::filesystem::path& study_folder);

/// The numbers of the cameras that have tracks in it.
[[nodiscard]] std::vector<int> CamerasOfStream(const std::filesystem::path& stream_folder);

[[nodiscard]] StudyStreamInfo ReadStreamInfo(const std::filesystem::path& stream_folder);
/// The same from its text; `file` is for errors. Throws InputError.
[[nodiscard]] StudyStreamInfo ParseStreamInfo(std::string_view text, const std::string& file);

/// What of a stream's files is not as stream.json lists it: path and what is wrong with it.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> ChangesOfStream(
    const std::filesystem::path& stream_folder, const StudyStreamInfo& info);

}  // namespace duet
