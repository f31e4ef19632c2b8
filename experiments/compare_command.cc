#include <gflags/gflags.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/text_file.h"
#include "evaluation/comparison.h"
#include "evaluation/requirements.h"
#include "experiments/calibration_watch.h"
#include "experiments/child_process.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/default_recording.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/late_start.h"
#include "experiments/record_folder.h"
#include "experiments/record_reader.h"
#include "experiments/session.h"
#include "experiments/settings_foot.h"

DECLARE_string(tracks);
DEFINE_string(
    require, "",
    "A bound on comparison.json, e.g. 'msckf.ate.position_m<0.01'; exit status 1 where it "
    "does not hold.");

namespace duet {
namespace fs = std::filesystem;
namespace {

std::vector<Requirement> ParseRequirements(const CommandLine& line) {
  const nlohmann::ordered_json paths = ComparisonTemplate(EstimatorNames());
  std::vector<Requirement> requirements;
  for (const std::string& text : line.All("require")) {
    requirements.push_back(ParseRequirement(text));
    CheckRequirementPath(requirements.back(), paths, true);
  }
  return requirements;
}

/// One comparison from the command line to the table.
class Comparator {
 public:
  Comparator(const CommandLine& line, const LogCapture& log)
      : line_(line),
        record_(FLAGS_out.empty() ? FreeFolder("duet-compare") : FLAGS_out, line.text(), log),
        dataset_(FLAGS_dataset) {}

  int Run(const std::vector<Requirement>& requirements) {
    if (dataset_.empty()) {
      const DefaultRecording made =
          FindOrMakeDefaultRecording(FLAGS_cameras == "0" ? 1 : 2, FLAGS_seed, FLAGS_quiet);
      if (made.interrupted) return kInterrupted;
      dataset_ = made.folder.string();
      if (!line_.Given("init")) FLAGS_init = "groundtruth";
    }
    session_ = OpenSession(line_, dataset_, FLAGS_tracks);
    (void)session_.Start();  // refuses a start that the recording does not allow, before the work
    comparison_.dataset = NameOf(session_.recording.folder);
    if (!session_.recording.label.empty()) comparison_.dataset += ": " + session_.recording.label;
    if (const int status = Track(); status != kDone) return Finish(status);
    for (const std::string& name : EstimatorNames()) {
      if (const int status = RunEstimator(name); status != kDone) return Finish(status);
    }
    Evaluate();
    return Finish(Report(requirements));
  }

 private:
  /// A name that is free: PREFIX-1, PREFIX-2, ...
  static std::string FreeFolder(const std::string& prefix) {
    for (int i = 1;; ++i) {
      std::string name = prefix + "-" + std::to_string(i);
      if (!fs::exists(name)) return name;
    }
  }

  static std::string NameOf(const fs::path& mav) {
    const fs::path folder = fs::weakly_canonical(mav);
    return (folder.filename() == "mav0" ? folder.parent_path() : folder).filename().string();
  }

  [[nodiscard]] bool tracks_live() const { return session_.recording.vision == Vision::kImages; }

  /// Flags that the parts of the comparison have in common with the whole.
  [[nodiscard]] std::vector<std::string> SharedArguments() const {
    std::vector<std::string> arguments = {"--dataset", dataset_, "--init", FLAGS_init};
    for (const char* flag : {"config", "set", "cameras", "threads", "seed"}) {
      for (const std::string& value : line_.All(flag)) {
        arguments.push_back(std::string("--") + flag + "=" + value);
      }
    }
    if (FLAGS_quiet) arguments.emplace_back("--quiet");
    return arguments;
  }

  void AddSpan(std::vector<std::string>* arguments) const {
    for (const char* flag : {"start", "duration"}) {
      for (const std::string& value : line_.All(flag)) {
        arguments->push_back(std::string("--") + flag + "=" + value);
      }
    }
  }

  int Track() {
    if (!tracks_live()) {
      comparison_.frontend.emplace().replayed = true;
      return kDone;
    }
    std::vector<std::string> arguments = SharedArguments();
    arguments.insert(arguments.begin(), "track");
    arguments.insert(arguments.end(), {"--out", (record_.path() / "tracks").string()});
    AddSpan(&arguments);
    // Decoding runs ahead in its own thread: on all cores.
    const ChildResult child = RunSelf(arguments, std::nullopt);
    if (child.signal != 0) {
      throw std::runtime_error("tracking was ended by signal " + std::to_string(child.signal));
    }
    if (child.exit_status == kDone)
      comparison_.frontend = ReadTrackRecord(record_.path() / "tracks");
    return child.exit_status;
  }

  static StartWait WaitOf(const EstimatorRun& run) {
    return {.frames_waited = run.waiting_frames,
            .frames = run.frames,
            .waited_s = run.waited_s,
            .missing = run.waited_for};
  }

  /// Each estimator alone on one core, one after the other. That it fails is a result.
  int RunEstimator(const std::string& name) {
    const fs::path folder = record_.path() / name;
    std::vector<std::string> arguments = SharedArguments();
    arguments.insert(arguments.begin(), "run");
    arguments.insert(arguments.end(),
                     {"--backend", name, "--out", folder.string(), "--covariance"});
    if (tracks_live()) {
      arguments.insert(arguments.end(), {"--tracks", (record_.path() / "tracks").string()});
    } else {
      if (!FLAGS_tracks.empty()) arguments.insert(arguments.end(), {"--tracks", FLAGS_tracks});
      AddSpan(&arguments);
    }
    const ChildResult child = RunSelf(arguments, CoreForMeasuring());
    if (child.exit_status == kInterrupted || child.exit_status == kWritingFailed) {
      return child.exit_status;
    }
    RunRecord run = ReadRunRecord(folder, child, session_.recording.FrameStamps().front());
    run.run.settings = SettingsFoot(session_.sources.values(), name, {folder});
    CHECK(run.tracks_sha256.empty() || comparison_.tracks_sha256.empty() ||
          run.tracks_sha256 == comparison_.tracks_sha256)
        << "the estimators ran on different tracks";
    if (!run.tracks_sha256.empty()) comparison_.tracks_sha256 = run.tracks_sha256;
    // NEES only where the tracks are no real camera's: the errors of real ones are not known well
    // enough for a claim.
    if (session_.recording.truth && (FLAGS_init == "groundtruth" || FLAGS_init == "drawn") &&
        !run.trajectory.empty() && !fs::exists(session_.recording.folder / "cam0")) {
      const GroundTruth truth = session_.TruthStatesFor(session_.Setup());
      run.run.nees = SummarizeNees(ComputeRecordNees(folder, truth),
                                   session_.configuration.evaluation.nees_settle_s);
    }
    if (const std::optional<std::string> late = LateStartWarning(WaitOf(run.run));
        late && !run.trajectory.empty()) {
      comparison_.warnings.push_back(name + " " + *late);
    }
    const fs::path calibration = folder / "calibration.csv";
    if (fs::exists(calibration)) {
      const std::vector<CalibrationWatch::Number> numbers =
          ReadCalibrationCsv(ReadTextFile(calibration), calibration.string());
      for (const std::string& warning : CalibrationWarnings(numbers)) {
        comparison_.warnings.push_back(name + ": " + warning);
      }
      calibration_text_ += "\n" + name + "\n" + CalibrationWatchText(numbers);
    }
    comparison_.runs.push_back(std::move(run.run));
    estimates_.push_back({name, std::move(run.trajectory)});
    return kDone;
  }

  void Evaluate() {
    const Recording& recording = session_.recording;
    EvaluationOptions options = session_.configuration.evaluation.Options();
    const std::vector<Timestamp> stamps = recording.FrameStamps();
    NamedTrajectory truth{"ground truth", {}};
    if (recording.truth) {
      truth = {recording.truth_file, session_.TruthFor(session_.Setup())};
      options.start = std::max(stamps.front(), truth.poses.front().timestamp);
      options.end = std::min(stamps.back(), truth.poses.back().timestamp);
    } else {
      LOG(WARNING) << "the recording has no ground truth: no errors, only cost";
    }
    comparison_.evaluation = duet::Evaluate(truth, estimates_, options);
    comparison_.cameras = FLAGS_cameras;
    comparison_.start = FLAGS_init;
  }

  int Report(const std::vector<Requirement>& requirements) {
    const nlohmann::ordered_json json = ComparisonJson(comparison_);
    std::string text = ComparisonText(comparison_) + calibration_text_;
    bool all_met = true;
    for (const Requirement& requirement : requirements) {
      const RequirementOutcome outcome = EvaluateRequirement(requirement, json);
      all_met = all_met && outcome.met;
      text += "required: " + outcome.text + "\n";
    }
    WriteTextFile(record_.path() / "comparison.json", json.dump(2) + "\n");
    WriteTextFile(record_.path() / "comparison.txt", text);
    std::fputs(text.c_str(), stdout);
    return all_met ? kDone : kBoundNotMet;
  }

  /// Keeps what is finished where the program was interrupted; nothing of bad input.
  int Finish(int status) {
    if (status != kDone && status != kBoundNotMet && status != kInterrupted) return status;
    Manifest& manifest = record_.manifest();
    manifest["dataset"] = DescribeRecording(session_.recording);
    manifest["tracks_sha256"] = comparison_.tracks_sha256;
    manifest["init"] = FLAGS_init;
    manifest["seed"] = FLAGS_seed;
    manifest["warnings"] = comparison_.warnings;  // of the runs; this program's own are added
    manifest["outcome"] = {{"status", status == kInterrupted ? "interrupted" : "done"}};
    record_.Commit(session_.sources);
    if (!FLAGS_quiet) std::fprintf(stderr, "wrote %s\n", record_.target().c_str());
    return status;
  }

  const CommandLine& line_;
  RecordFolder record_;
  std::string dataset_;
  Session session_;
  Comparison comparison_;
  std::vector<NamedTrajectory> estimates_;
  std::string calibration_text_;  // a table an estimator
};

int RunCompare(const CommandLine& line) {
  if (!FLAGS_out.empty()) RequireAbsent(FLAGS_out);
  const std::vector<Requirement> requirements = ParseRequirements(line);
  LogCapture log(FLAGS_quiet);
  return Comparator(line, log).Run(requirements);
}

}  // namespace

Command CompareCommand() {
  Command command = {
      .name = "compare",
      .summary = "Tracks once, runs both estimators on the identical tracks, and compares them.",
      .description =
          "The head-to-head: tracks a recording's images once (or takes a recorded track stream), "
          "runs the filter and the optimizer on that stream, each alone in its own process on one "
          "core, evaluates both against the ground truth, prints the table and writes it as "
          "comparison.txt and comparison.json beside the run records. Without --dataset on a "
          "sequence that Duet renders once and keeps ($DUET_CACHE, else ~/.cache/duet). Without "
          "--out into duet-compare-<n>. That an estimator "
          "fails is a result (exit status 0).",
      .example = "duet compare --dataset MH_01_easy --init groundtruth --out compare-mh01",
      .flags = CommonFlags(false),
      .run = RunCompare};
  command.flags.push_back({.name = "tracks", .value = "DIR"});
  command.flags.push_back({.name = "require", .value = "BOUND", .repeatable = true});
  return command;
}

}  // namespace duet
