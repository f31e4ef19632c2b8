#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "test/acceptance/program.h"

namespace duet {

/// A study of two estimators and two seeds over three seconds with few tracks: seconds in all.
inline constexpr const char* kTinyStudy =
    "study: tiny\n"
    "streams:\n"
    "  - name: room\n"
    "    simulate: room_easy\n"
    "    set: {simulation.duration_s: 3, simulation.max_tracks: 30}\n"
    "set: {shared.calibration.t_d.state: estimated}\n"
    "seeds: 1..2\n"
    "figures: [rmse_over_runs]\n";

/// Whatever of a study's folder is the same bytes every time, by its path.
[[nodiscard]] inline std::map<std::string, std::string> CanonicalFilesOf(
    const std::filesystem::path& study) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(study)) {
    const std::string name = entry.path().filename().string();
    const std::string path = entry.path().lexically_relative(study).string();
    const bool is_varying = name == "manifest.json" || name == "timing.csv" || name == "lock" ||
                            name == "runs.csv" || name == "config.yaml" || name == "summary.txt" ||
                            name == "log.txt" || name == "report.html" || name.ends_with(".lock") ||
                            name.ends_with(".pdf") || path.starts_with("slurm");
    if (entry.is_regular_file() && !is_varying) files[path] = ReadFile(entry.path());
  }
  return files;
}

}  // namespace duet
