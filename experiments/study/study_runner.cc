#include "experiments/study/study_runner.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"
#include "experiments/command_line.h"
#include "experiments/interrupt.h"
#include "experiments/log_capture.h"
#include "experiments/manifest.h"
#include "experiments/progress.h"
#include "experiments/study/child_pool.h"
#include "experiments/study/record_version.h"
#include "experiments/study/run_time.h"
#include "experiments/study/study_lock.h"
#include "experiments/study/study_records.h"
#include "experiments/study/study_run.h"
#include "experiments/study/study_stream.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr double kWait_s = 0.5;
/// Processes of a study that was killed are gone within a frame.
constexpr int kLockTries = 40;
constexpr useconds_t kLockPause_us = 50000;

StudyLock LockFolder(const fs::path& folder, StudyLock::Kind kind) {
  for (int i = 0; i < kLockTries; ++i) {
    if (auto lock = StudyLock::Try(folder / "lock", kind)) return std::move(*lock);
    usleep(kLockPause_us);
  }
  throw InputError(folder.string(), 0, "",
                   "another process works in this folder; wait for it, or give another --out");
}

/// Another study's folder is not taken over.
void RequireSameStudy(const StudyFile& study, const fs::path& folder) {
  const fs::path file = folder / "study.yaml";
  if (!fs::exists(file)) {
    if (!fs::exists(folder) || fs::is_empty(folder)) return;
    throw InputError(folder.string(), 0, "",
                     "exists and is no study's folder; --out expects a new or a study's one");
  }
  const YamlNode root = ParseYaml(ReadTextFile(file), file.string());
  const YamlNode* name = root.Find("study");
  if (name != nullptr && name->scalar == study.name) return;
  throw InputError(folder.string(), 0, "",
                   "holds the study '" + (name == nullptr ? "" : name->scalar) + "', not '" +
                       study.name + "'; expected another --out");
}

void WritePlan(const StudyPlan& plan, const fs::path& folder) {
  MakeFolder(folder / "runs");
  MakeFolder(folder / "streams");
  StudyFile written = plan.study;
  if (!plan.study.published.empty()) {
    written.published = "published";  // the folder's own copy
    MakeFolder(folder / "published");
    for (const fs::directory_entry& entry : fs::directory_iterator(plan.study.published)) {
      if (entry.path().extension() != ".csv") continue;
      ReplaceTextFile(folder / "published" / entry.path().filename(), ReadTextFile(entry.path()));
    }
  } else {
    std::error_code ignored;
    fs::remove_all(folder / "published", ignored);  // of an earlier form of the study
  }
  if (!plan.recordings.empty()) WriteRecordings(plan.recordings, folder);
  ReplaceTextFile(folder / "study.yaml", StudyYaml(written));
  ReplaceTextFile(folder / "plan.csv", PlanCsv(plan));
}

/// Indices of the runs without a whole record; records of another version are refused. `damaged`:
/// a line for each record that is there and has to be made again.
std::vector<int> RunsLeft(const StudyPlan& plan, const fs::path& folder,
                          std::vector<std::string>* damaged = nullptr) {
  std::vector<int> left;
  for (const int index : plan.Distinct()) {
    const std::string& id = plan.runs[static_cast<std::size_t>(index)].id;
    const fs::path record = RecordFolderOf(folder, id);
    const bool is_there = fs::exists(record);
    const std::string damage = is_there ? DamageOfRecord(record) : "";
    if (is_there && damage.empty()) continue;
    left.push_back(index);
    if (is_there && damaged != nullptr) damaged->push_back("runs/" + id + ": " + damage);
  }
  return left;
}

/// Streams whose runs are there already and that are not themselves, made again. False where the
/// program was interrupted.
bool RestoreStreams(const StudyPlan& plan, const fs::path& folder) {
  std::set<std::string> seen;
  for (const PlannedStream& stream : plan.streams) {
    if (!seen.insert(stream.id).second || fs::exists(StreamFolder(folder, stream.id))) continue;
    if (!EnsureStream(plan, stream, folder)) return false;
  }
  return true;
}

/// What main() does with exceptions, in a child.
int RunGuarded(const std::function<int()>& work) {
  const auto fail = [](ExitStatus status, const char* what) {
    std::fprintf(stderr, "duet: %s\n", what);
    return status;
  };
  try {
    return work();
  } catch (const InputError& error) {
    return fail(kBadInput, error.what());
  } catch (const OutputError& error) {
    return fail(kWritingFailed, error.what());
  } catch (const std::exception& error) {
    return fail(kInternalError, (std::string("internal error: ") + error.what()).c_str());
  }
}

std::string DescribeEnd(const ChildResult& child) {
  if (child.signal != 0) return "its process was ended by signal " + std::to_string(child.signal);
  return "its process ended with status " + std::to_string(child.exit_status);
}

/// The runs of a plan through processes of their own.
class StudyExecution {
 public:
  StudyExecution(const StudyPlan& plan, const StudyChoices& choices, std::vector<int> left)
      : plan_(plan),
        choices_(choices),
        left_(std::move(left)),
        jobs_(plan.study.measure_time ? 1 : choices.jobs),
        progress_(plan.study.name, static_cast<std::int64_t>(left_.size()), "runs", choices.quiet) {
    if (plan.study.measure_time) core_ = CoreForMeasuring();
  }

  /// kDone, kInterrupted, or what a child that can't go on ended with.
  int Run() {
    std::size_t next = 0;
    while (next < left_.size() || pool_.running() > 0) {
      while (next < left_.size() && pool_.running() < jobs_ && status_ == kDone && !Interrupted()) {
        StartRun(left_[next++]);
      }
      if (pool_.running() == 0) break;
      if (const std::optional<ChildPool::Ended> ended = pool_.Wait(kWait_s)) Take(*ended);
      progress_.Update(done_);
    }
    if (Interrupted()) status_ = kInterrupted;
    progress_.Finish(status_ == kInterrupted ? "interrupted" : died_ > 0 ? DiedText() : "");
    return status_;
  }

  [[nodiscard]] int died() const { return died_; }

 private:
  [[nodiscard]] const PlannedRun& RunOf(int index) const {
    return plan_.runs[static_cast<std::size_t>(index)];
  }
  [[nodiscard]] std::string DiedText() const {
    return std::to_string(died_) + " of them without a record: their process died";
  }

  void StartRun(int index) {
    const PlannedRun& run = RunOf(index);
    std::error_code ignored;
    fs::remove(FailureFile(choices_.out, run.id), ignored);
    pool_.Start(index, core_, [&] {
      return RunGuarded(
          [&] { return RunStudyRun(plan_, run, choices_.out, choices_.command_line); });
    });
  }

  void Take(const ChildPool::Ended& ended) {
    const ChildResult& result = ended.result;
    const bool stops = result.signal == 0 &&
                       (result.exit_status == kBadInput || result.exit_status == kWritingFailed);
    if (result.signal == 0 && result.exit_status == kInterrupted) return;
    if (stops) {
      status_ = result.exit_status;
      return;
    }
    ++done_;
    if (result.signal == 0 && result.exit_status == kDone) return;
    if (Interrupted()) return;
    ++died_;
    MakeFolder(choices_.out / "failures");
    ReplaceTextFile(FailureFile(choices_.out, RunOf(ended.number).id), DescribeEnd(result) + "\n");
  }

  const StudyPlan& plan_;
  const StudyChoices& choices_;
  const std::vector<int> left_;
  const int jobs_;
  std::optional<int> core_;
  Progress progress_;
  ChildPool pool_;
  int done_ = 0;
  int died_ = 0;
  int status_ = kDone;
};

void RemoveLocksOfStreams(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / "streams", ignored)) {
    if (entry.path().extension() == ".lock") fs::remove(entry.path(), ignored);
  }
}

/// The log is caught while it lives: no longer than this, since children have one of their own.
StudyPlan PlanAloud(StudyFile study, const StudyChoices& choices) {
  const LogCapture log(choices.quiet);
  return MakeStudyPlan(std::move(study), choices.data);
}

}  // namespace

int RunStudy(const StudyChoices& choices) {
  return RunStudy(ReadStudyFile(choices.file, choices.quick), choices);
}

int RunStudy(StudyFile study, const StudyChoices& choices) {
  const StudyPlan plan = PlanAloud(std::move(study), choices);
  RequireSameStudy(plan.study, choices.out);
  MakeFolder(choices.out);
  const StudyLock lock = LockFolder(choices.out, StudyLock::Kind::kExclusive);
  std::vector<std::string> damaged;
  std::vector<int> left = RunsLeft(plan, choices.out, &damaged);
  for (const std::string& line : damaged) PrintWarning(line + "; it is run again");
  WritePlan(plan, choices.out);
  for (const char* part : {"", "runs", "streams", "tables", "figures", "failures", "published"}) {
    RemoveAbandonedPartials(choices.out / part);
  }
  const std::size_t all = plan.Distinct().size();
  const std::size_t before = all - left.size();
  if (before > 0 && !choices.quiet) {
    std::fprintf(stderr, "%s: %zu of %zu runs are there already\n", plan.study.name.c_str(), before,
                 all);
  }
  StudyExecution execution(plan, choices, std::move(left));
  int status = execution.Run();
  if (status == kDone && !RestoreStreams(plan, choices.out)) status = kInterrupted;
  if (status != kDone) {
    const std::size_t open = RunsLeft(plan, choices.out).size();
    std::fprintf(stderr, "duet: %zu of %zu runs are done and kept; the same command goes on\n",
                 all - open, all);
    return status;
  }
  RemoveLocksOfStreams(choices.out);
  WriteStudyProducts(choices.out, choices.quick, choices.command_line, choices.finish);
  if (choices.print_summary) {
    std::fputs(ReadTextFile(choices.out / "summary.txt").c_str(), stdout);
  }
  return execution.died() > 0 ? kInternalError : kDone;
}

int RunStudyById(const StudyChoices& choices, const std::string& id) {
  MakeFolder(choices.out);
  const StudyLock lock = LockFolder(choices.out, StudyLock::Kind::kShared);
  const StudyPlan plan = MakeStudyPlan(ReadStudyFile(choices.file, choices.quick), choices.data,
                                       ReadRecordings(choices.out));
  RequireSameStudy(plan.study, choices.out);
  if (!fs::exists(choices.out / "plan.csv")) WritePlan(plan, choices.out);
  for (const PlannedRun& run : plan.runs) {
    if (run.id == id) return RunStudyRun(plan, run, choices.out, choices.command_line);
  }
  throw InputError("", 0, "--run",
                   "the study has no run '" + id + "'; duet study --plan lists them");
}

int DryRunStudy(const StudyChoices& choices) {
  return DryRunStudy(ReadStudyFile(choices.file, choices.quick), choices);
}

int DryRunStudy(StudyFile study, const StudyChoices& choices) {
  const StudyPlan plan = PlanAloud(std::move(study), choices);
  RequireSameStudy(plan.study, choices.out);
  const std::vector<int> left = RunsLeft(plan, choices.out);
  const std::size_t all = plan.Distinct().size();
  std::set<std::string> streams;
  std::size_t there = 0;
  for (const PlannedStream& stream : plan.streams) {
    if (!streams.insert(stream.id).second) continue;
    there += fs::exists(StreamFolder(choices.out, stream.id)) ? 1 : 0;
  }
  const int jobs = plan.study.measure_time ? 1 : choices.jobs;
  const TimeEstimate estimate = EstimateTime(plan, left, choices.out);
  std::printf("%s: %zu runs, %zu of them there already; %zu streams, %zu there\n",
              plan.study.name.c_str(), all, all - left.size(), streams.size(), there);
  if (plan.runs.size() > all) {
    std::printf(
        "%zu cells of the grid share a record with another: nothing that differs reaches "
        "their estimator\n",
        plan.runs.size() - all);
  }
  std::printf("about %s with %d at once, %s\n", DurationText(estimate.total_s / jobs).c_str(), jobs,
              estimate.from.c_str());
  return kDone;
}

int PrintStudyPlan(const StudyChoices& choices) {
  const StudyPlan plan = PlanAloud(ReadStudyFile(choices.file, choices.quick), choices);
  RequireSameStudy(plan.study, choices.out);
  MakeFolder(choices.out);
  {
    const StudyLock lock = LockFolder(choices.out, StudyLock::Kind::kExclusive);
    WritePlan(plan, choices.out);
  }
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  std::string command = ShellQuoted(program) + " study " +
                        ShellQuoted(fs::absolute(choices.file).lexically_normal().string()) +
                        " --out " + ShellQuoted(fs::absolute(choices.out).lexically_normal());
  if (!choices.data.empty()) {
    command += " --data " + ShellQuoted(fs::absolute(choices.data).lexically_normal());
  }
  if (choices.quick) command += " --quick";
  for (const int index : RunsLeft(plan, choices.out)) {
    std::printf("%s --run %s\n", command.c_str(),
                plan.runs[static_cast<std::size_t>(index)].id.c_str());
  }
  return kDone;
}

}  // namespace duet
