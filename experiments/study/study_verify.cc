#include "experiments/study/study_verify.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>

#include "common/support/input_error.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"
#include "experiments/configuration.h"
#include "experiments/interrupt.h"
#include "experiments/study/record_version.h"
#include "experiments/study/run_evaluation.h"
#include "experiments/study/study_products.h"
#include "experiments/study/study_records.h"
#include "experiments/study/study_run.h"
#include "experiments/study/study_stream.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

/// The value of "key=value" among lines.
std::string ValueOfLine(const std::string& lines, const std::string& key) {
  const std::string head = key + "=";
  std::size_t begin = 0;
  while (begin < lines.size()) {
    const std::size_t end = std::min(lines.find('\n', begin), lines.size());
    if (lines.compare(begin, head.size(), head) == 0) {
      return lines.substr(begin + head.size(), end - begin - head.size());
    }
    begin = end + 1;
  }
  return "";
}

class StudyVerifier {
 public:
  StudyVerifier(const fs::path& folder, const StudyDerivation& derive)
      : folder_(folder), derive_(derive) {}

  StudyVerification Verify() {
    if (!IsStudyFolder(folder_)) {
      throw InputError(folder_.string(), 0, "",
                       "has no plan.csv and study.yaml; expected the folder of duet study");
    }
    std::map<std::string, std::set<std::string>> runs_of_stream;
    for (const StudyRun& cell : ReadPlan(folder_)) runs_of_stream[cell.stream_id].insert(cell.id);
    for (const auto& [stream, runs] : runs_of_stream) {
      if (Interrupted()) return std::move(result_);
      VerifyStream(stream, runs);
    }
    if (result_.problems.empty()) VerifyPlan();
    if (result_.problems.empty()) VerifyTexts();
    NoteOthers(runs_of_stream);
    return std::move(result_);
  }

 private:
  void Problem(const fs::path& path, const std::string& text) {
    result_.problems.push_back(path.lexically_relative(folder_).string() + ": " + text);
  }

  void VerifyStream(const std::string& id, const std::set<std::string>& runs) {
    const fs::path folder = StreamFolder(folder_, id);
    std::optional<Recording> recording;
    StudyStreamInfo info;
    std::string stream_sha256;
    if (!fs::exists(folder)) {
      Problem(folder, "is missing");
    } else {
      ++result_.streams;
      try {
        info = ReadStreamInfo(folder);
        stream_sha256 = Sha256Hex(ReadTextFile(folder / "stream.json"));
        recording = CheckStream(folder, id, info);
      } catch (const InputError& error) {
        Problem(folder, error.what());
      }
    }
    for (const std::string& run : runs) {
      const fs::path record = RecordFolderOf(folder_, run);
      if (!fs::exists(record)) {
        Problem(record, "is missing");
        continue;
      }
      ++result_.runs;
      try {
        const bool is_whole = CheckRecord(record, run, id, stream_sha256);
        const bool is_own = IsOwn(record);
        if (recording && is_own && is_whole) CheckEvaluation(record, *recording, info.simulated);
      } catch (const InputError& error) {
        Problem(record, error.what());
      }
    }
  }

  /// False, with a line that says so, for what another version has made.
  bool IsOwn(const fs::path& folder) {
    const RecordVersion version = VersionOf(folder);
    if (version == OwnVersion()) return true;
    Problem(folder, "is from another version: " + version.Text() + "; this is " +
                        OwnVersion().Text() + ", which derives no number of it");
    return false;
  }

  std::optional<Recording> CheckStream(const fs::path& folder, const std::string& id,
                                       const StudyStreamInfo& info) {
    if (info.id != id || StudyId(info.determined_by) != id) {
      Problem(folder / "stream.json", "has changed: its lines do not give the id");
    }
    for (const auto& [file, change] : ChangesOfStream(folder, info)) Problem(folder / file, change);
    RecordingOptions options;
    options.source = RecordingOptions::Source::kTracks;
    options.cameras = CamerasOfStream(folder);
    Recording recording = LoadRecording(folder, options);
    if (HashTrackStream(recording.tracks.frames) != info.tracks_sha256) {
      Problem(folder, "its tracks have changed: they do not give tracks_sha256");
    }
    if (!IsOwn(folder)) return std::nullopt;
    return recording;
  }

  /// False where files of it are missing. `stream_sha256`: of stream.json; empty: not known.
  bool CheckRecord(const fs::path& record, const std::string& id, const std::string& stream_id,
                   const std::string& stream_sha256) {
    const StudyRecordInfo info = ReadRecordInfo(record);
    if (!info.unchanged) Problem(record / "study.json", "has changed since it was written");
    if (!stream_sha256.empty() && info.stream_sha256 != stream_sha256) {
      Problem(record, "ran on another streams/" + stream_id + " than there is now");
    }
    if (info.id != id || StudyId(info.determined_by) != id || info.stream_id != stream_id ||
        ValueOfLine(info.determined_by, "stream") != stream_id) {
      Problem(record / "study.json", "has changed: its lines do not give the id");
    }
    bool is_whole = true;
    std::set<std::string> listed;
    for (const auto& [name, hash] : info.files) {
      listed.insert(name);
      if (!fs::exists(record / name)) {
        is_whole = false;
        Problem(record / name, "is missing");
      } else if (Sha256Hex(ReadTextFile(record / name)) != hash) {
        Problem(record / name, "has changed since it was written");
      }
    }
    for (const std::string& name : CanonicalFiles()) {
      if (fs::exists(record / name) && !listed.contains(name)) {
        Problem(record / name, "has come since the record was written");
      }
    }
    ConfigSources sources;
    sources.AddFile(record / "config.yaml");
    Configuration configuration;
    configuration.Read(&sources);
    const std::string estimator = ValueOfLine(info.determined_by, "estimator");
    if (RunSettingsSha256(sources.values(), estimator) !=
        ValueOfLine(info.determined_by, "settings_sha256")) {
      Problem(record / "config.yaml", "holds other settings than the record's id stands for");
    }
    return is_whole;
  }

  void CheckEvaluation(const fs::path& record, const Recording& recording, bool simulated) {
    const RunEvaluation evaluation = EvaluateRecord(record, recording, simulated);
    for (const auto& [name, text] : EvaluationTexts(evaluation)) {
      if (!fs::exists(record / name)) {
        Problem(record / name, "is missing");
      } else if (ReadTextFile(record / name) != text) {
        Problem(record / name, "is not what the record gives");
      }
    }
  }

  void VerifyPlan() {
    const fs::path file = folder_ / "study.yaml";
    try {
      const StudyPlan plan =
          MakeStudyPlan(ReadStudyFile(file, /*quick=*/false), "", ReadRecordings(folder_));
      if (PlanCsv(plan) != ReadTextFile(folder_ / "plan.csv")) {
        Problem(folder_ / "plan.csv", "is not the grid that study.yaml gives");
      }
    } catch (const InputError& error) {
      Problem(file, error.what());
    }
  }

  void VerifyTexts() {
    const StudyFolder study = ReadStudyFolder(folder_);
    auto texts = StudyTexts(study);
    if (derive_) {
      for (auto& text : derive_(study)) texts.push_back(std::move(text));
    }
    std::set<std::string> derived;
    for (const auto& [name, text] : texts) {
      derived.insert(name);
      if (!fs::exists(folder_ / name)) {
        Problem(folder_ / name, "is missing; the study's command writes it");
      } else if (ReadTextFile(folder_ / name) != text) {
        Problem(folder_ / name, "is not what the records give");
      }
    }
    for (const auto& [name, hash] : ReadProducts(folder_)) {
      if (derived.contains(name)) continue;
      if (!fs::exists(folder_ / name)) {
        Problem(folder_ / name, "is missing; the study's command writes it");
      } else if (Sha256Hex(ReadTextFile(folder_ / name)) != hash) {
        Problem(folder_ / name, "has changed since it was written");
      }
    }
  }

  void NoteOthers(const std::map<std::string, std::set<std::string>>& runs_of_stream) {
    std::set<std::string> planned;
    for (const auto& [stream, runs] : runs_of_stream) planned.insert(runs.begin(), runs.end());
    std::error_code ignored;
    std::vector<std::string> others;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / "runs", ignored)) {
      const std::string name = entry.path().filename().string();
      if (!planned.contains(name)) others.push_back("runs/" + name + ": is in no cell of the grid");
    }
    std::sort(others.begin(), others.end());
    result_.notes = std::move(others);
  }

  const fs::path folder_;
  const StudyDerivation& derive_;
  StudyVerification result_;
};

}  // namespace

StudyVerification VerifyStudy(const fs::path& folder, const StudyDerivation& derive) {
  return StudyVerifier(folder, derive).Verify();
}

}  // namespace duet
