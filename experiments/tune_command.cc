#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/study/study_runner.h"
#include "experiments/study/tuning_result.h"

DECLARE_int32(jobs);
DECLARE_bool(quick);
DECLARE_string(data);
DECLARE_bool(dry_run);

namespace duet {
namespace {

int RunTune(const CommandLine& line) {
  if (line.operands().size() != 1) {
    throw InputError("duet tune needs the file of one search; see duet help tune");
  }
  if (FLAGS_jobs < 1) throw InputError("", 0, "--jobs", "expected at least 1");
  const std::filesystem::path file = line.operands().front();
  TuningFile tuning = ParseTuningFile(ReadTextFile(file), file, FLAGS_quick);
  for (StudyStream& stream : tuning.report_streams) MakePathsAbsolute(file, FLAGS_data, &stream);
  const StudyChoices choices = {.file = file,
                                .out = FLAGS_out,
                                .data = FLAGS_data,
                                .quick = FLAGS_quick,
                                .jobs = FLAGS_jobs,
                                .quiet = FLAGS_quiet,
                                .print_summary = false,
                                .command_line = line.text()};
  if (FLAGS_dry_run) return DryRunStudy(tuning.study, choices);
  if (!std::filesystem::exists(choices.out / "plan.csv")) {
    // One run first, so that an objective which no run has is not found out after the search.
    StudyFile first = tuning.study;
    first.settings.resize(1);
    first.seeds.last = first.seeds.first;
    const int status = RunStudy(first, choices);
    if (status != kDone) return status;
    (void)TuningTrials(ReadStudy(choices.out), tuning.objective);
  }
  const int status = RunStudy(tuning.study, choices);
  if (status != kDone && status != kInternalError) return status;
  ReplaceTextFile(choices.out / "tuning.yaml", TuningYaml(tuning));
  const StudyFolder folder = ReadStudyFolder(choices.out);
  for (const auto& [name, text] : TuningTexts(folder)) ReplaceTextFile(choices.out / name, text);
  std::fputs(ReadTextFile(choices.out / "search.txt").c_str(), stdout);
  return status;
}

}  // namespace

Command TuneCommand() {
  return {
      .name = "tune",
      .summary = "Tunes every estimator with the same effort, on seeds that no report contains.",
      .description =
          "Tries the same number of settings of each estimator (the `budget` of the file, drawn at "
          "random from the values that it lists; configs/tuning/ has one), on streams and seeds "
          "apart from those of the report (report_seeds and, where the search runs on recordings, "
          "report_streams). The whole search stays as a study's folder, with "
          "search.csv; report.yaml is the study that shows what tuning bought on the report's "
          "seeds. docs/studies.md.",
      .example = "duet tune configs/tuning/room.yaml --jobs 2 --out tuned",
      .flags = {{.name = "out",
                 .value = "DIR",
                 .required = true,
                 .meaning = "Folder of the search; where it exists, what is in it is not done "
                            "again."},
                {.name = "quick"},
                {.name = "jobs",
                 .value = "N",
                 .meaning = "Runs at once, each a process. Costs a frame want 1."},
                {.name = "data", .value = "DIR", .without = "beside the file"},
                {.name = "dry-run"},
                {.name = "quiet"}},
      .operands = "FILE",
      .run = RunTune};
}

}  // namespace duet
