#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/yaml_node.h"
#include "experiments/seed_range.h"

namespace duet {

/// A configuration's key ("msckf.max_clones") with its value, and where it stands.
struct StudyKey {
  std::string key;
  YamlNode value;
  std::string file;
};

/// What estimators are run on: simulated for each seed, or a recording.
struct StudyStream {
  std::string name;
  int line = 0;
  std::string simulate;       ///< a preset of duet simulate; empty: `dataset`
  std::vector<StudyKey> set;  ///< simulation.* of a simulated one; frontend.* of a recording
  std::string dataset;        ///< folder, below --data or relative to the file
  std::vector<int> cameras = {0};
  /// Of a recording: the first seed starts at the first of these, the second at the second, ...
  std::vector<double> starts_s = {0.0};
  double duration_s = 0.0;  ///< of a run, from its start; 0: to the end
  double jitter_px = 0.0;   ///< 1 sigma that each pixel is moved by, drawn with the run's seed
  /// Of a simulated one: the seed of what is simulated, where it is not the run's.
  std::optional<int> simulation_seed;
  std::string init;  ///< as --init of duet run

  [[nodiscard]] bool simulated() const { return !simulate.empty(); }
};

/// A named set of changes to the configuration.
struct StudyChange {
  std::string name;
  std::vector<StudyKey> set;
  /// Over `set`, for one estimator alone: what tuning each for itself has found.
  std::map<std::string, std::vector<StudyKey>> only = {};
};

/// What the tables of a study test: pairs of estimators, of settings, or of perturbations.
enum class StudyCompare { kEstimators, kSettings, kPerturbations };
[[nodiscard]] const char* StudyCompareName(StudyCompare compare);

/// A study as its file says (docs/studies.md).
struct StudyFile {
  std::string file;  ///< for errors
  std::string name;
  std::string question;
  std::vector<StudyStream> streams;
  std::vector<std::string> estimators;
  std::vector<StudyKey> set;  ///< under every setting: the files of `config`, then `set`
  std::vector<StudyChange> settings;
  std::vector<StudyChange> perturbations;
  SeedRange seeds{1, 1};
  std::string baseline;  ///< a setting or a perturbation
  StudyCompare compare = StudyCompare::kEstimators;
  std::vector<std::string> metrics;
  std::optional<std::vector<std::string>> figures;  ///< empty: none; absent: a choice
  bool measure_time = false;
  /// Recordings that are not there are left out, and said; otherwise they are an error.
  bool skip_missing = false;
  std::string published;  ///< folder of published numbers to stand beside; empty: none
};

/// `quick`: with the keys of the file's `quick` in place of those above it. Strict: every error is
/// an InputError with file, line and key. Configurations and recordings are not yet looked at.
[[nodiscard]] StudyFile ParseStudyFile(std::string_view yaml, const std::filesystem::path& file,
                                       bool quick);
/// Makes a stream's paths independent of where the study's file lies: a recording's folder, found
/// below `data` where that is not empty, and files that its simulation reads.
void MakePathsAbsolute(const std::filesystem::path& study_file, const std::filesystem::path& data,
                       StudyStream* stream);

/// The same from a document that has been read.
[[nodiscard]] StudyFile StudyOfYaml(YamlNode root, const std::filesystem::path& file, bool quick);
[[nodiscard]] StudyFile ReadStudyFile(const std::filesystem::path& file, bool quick);

/// The items of `streams:` as a file has them, two blanks in.
[[nodiscard]] std::string StreamsYaml(const std::vector<StudyStream>& streams);
/// The study as a file that says the same, without other configuration files and with nothing left
/// out. Its paths are taken as they are: a plan's are absolute.
[[nodiscard]] std::string StudyYaml(const StudyFile& study);

}  // namespace duet
