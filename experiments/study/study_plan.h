#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/config_sources.h"
#include "experiments/configuration.h"
#include "experiments/simulation/simulator.h"
#include "experiments/study/study_file.h"

namespace duet {

/// What is known of a recording that a study runs on, without its data.
struct StudyRecording {
  std::filesystem::path path;
  std::string fingerprint;
  bool has_images = false;
  int frames = 0;
  std::optional<RigCalibration> rig = {};  ///< where it has been read; not in recordings.json
};
/// By dataset and cameras as the file gives them ("MH_01_easy [0]").
using StudyRecordings = std::map<std::string, StudyRecording>;
[[nodiscard]] std::string RecordingKey(const StudyStream& stream);

/// One input, made once: streams/<id>.
struct PlannedStream {
  std::string id;
  std::string determined_by;  ///< the lines that the id is the hash of
  int stream = 0;             ///< of StudyFile::streams
  int simulation_seed = 0;    ///< the file's, or the stream's own for the grid's seed
  int jitter_seed = 0;
  int frames = 0;  ///< of a run's span; 0 where it is not known
  /// Of a recording whose pixels are jittered: the stream without that.
  std::string base_id;
};

/// One cell of the grid, and the record that it is: runs/<id>. Cells may share a record, where they
/// differ in nothing that reaches the estimator.
struct PlannedRun {
  std::string id;
  std::string determined_by;
  int stream = 0;  ///< of StudyFile::streams; the others likewise
  int planned_stream = 0;
  std::string estimator;
  int setting = 0;
  int perturbation = 0;
  int seed = 0;        ///< the grid's
  int draw_seed = 0;   ///< of the start's and the told calibration's errors; the stream's own
  double start_s = 0;  ///< of a recording
};

/// The grid of a study: streams, perturbations, settings, estimators, seeds (which vary fastest).
struct StudyPlan {
  StudyFile study;
  StudyRecordings recordings;
  std::vector<PlannedStream> streams;
  std::vector<PlannedRun> runs;

  [[nodiscard]] const StudyStream& StreamOf(const PlannedRun& run) const {
    return study.streams[static_cast<std::size_t>(run.stream)];
  }
  [[nodiscard]] const PlannedStream& InputOf(const PlannedRun& run) const {
    return streams[static_cast<std::size_t>(run.planned_stream)];
  }
  /// Indices of the first cell of each record, in the order to run them: first one of each stream,
  /// so that runs at the same time seldom wait for one stream.
  [[nodiscard]] std::vector<int> Distinct() const;
};

/// Recordings are found below `data` where it is not empty, else relative to the study's file, and
/// read once; those that `known` has at the same place are taken from there. Throws InputError for
/// what is wrong in the file, in a configuration of the grid, or with a recording.
[[nodiscard]] StudyPlan MakeStudyPlan(StudyFile study, const std::filesystem::path& data,
                                      const StudyRecordings& known = {});

/// The settings of a run: what the stream tells, then what the study sets, each in its order.
[[nodiscard]] ConfigSources SourcesOfRun(const StudyPlan& plan, const PlannedRun& run);
/// The simulation of a stream with its seed.
[[nodiscard]] SimulationOptions SimulationOf(const StudyFile& study, const StudyStream& stream,
                                             int seed, ConfigSources* sources);
/// The front end's settings of a recording's stream, and the configuration that they give.
ConfigSources SourcesOfTracking(const StudyFile& study, const StudyStream& stream,
                                Configuration* configuration);

/// The hash over the settings that reach `estimator`'s run: its own group and the shared ones,
/// without the seed of the told errors, which stands apart.
[[nodiscard]] std::string RunSettingsSha256(const std::vector<ResolvedValue>& values,
                                            const std::string& estimator);
/// The first 16 digits of the lines' SHA-256.
[[nodiscard]] std::string StudyId(const std::string& determined_by);

/// recordings.json of a study's folder, and back; empty where there is none.
void WriteRecordings(const StudyRecordings& recordings, const std::filesystem::path& folder);
[[nodiscard]] StudyRecordings ReadRecordings(const std::filesystem::path& folder);
/// The same from its text; `file` is for errors. Throws InputError.
[[nodiscard]] StudyRecordings ParseRecordings(std::string_view text, const std::string& file);

}  // namespace duet
