#include <gflags/gflags.h>

#include "common/support/input_error.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/study/study_runner.h"
#include "experiments/study_pictures.h"

DECLARE_int32(jobs);
DEFINE_bool(quick, false, "With the keys below `quick` of the study's file: a first look.");
DEFINE_string(data, "", "Where the recordings of a study lie.");
DEFINE_bool(dry_run, false, "Say how many runs there are and how long they will take, and end.");
DEFINE_bool(plan, false, "Print one command for each run that is left, for an engine, and end.");
DEFINE_string(run, "", "Do this run of the plan alone.");

namespace duet {
namespace {

int RunStudyCommand(const CommandLine& line) {
  if (line.operands().size() != 1) {
    throw InputError("duet study needs the file of one study; see duet help study");
  }
  if (FLAGS_jobs < 1) throw InputError("", 0, "--jobs", "expected at least 1");
  const StudyChoices choices = {.file = line.operands().front(),
                                .out = FLAGS_out,
                                .data = FLAGS_data,
                                .quick = FLAGS_quick,
                                .jobs = FLAGS_jobs,
                                .quiet = FLAGS_quiet,
                                .finish = MakePictures,
                                .command_line = line.text()};
  const int ways = (FLAGS_dry_run ? 1 : 0) + (FLAGS_plan ? 1 : 0) + (line.Given("run") ? 1 : 0);
  if (ways > 1) throw InputError("--dry-run, --plan and --run do not go together");
  if (line.Given("run")) return RunStudyById(choices, FLAGS_run);
  const StudyFile study = ReadStudyFile(choices.file, choices.quick);
  CheckFigures(study);
  if (FLAGS_dry_run) return DryRunStudy(study, choices);
  if (FLAGS_plan) return PrintStudyPlan(choices);
  return RunStudy(study, choices);
}

}  // namespace

Command StudyCommand() {
  return {
      .name = "study",
      .summary = "Runs a whole study: recordings x estimators x settings x seeds, to its tables.",
      .description =
          "Runs the grid of a study's file (docs/studies.md; configs/studies/ has some): every "
          "stream is simulated or tracked once, every run is a record of its own in --out, named "
          "by the hash of all that determines it. Started again it does what is left; a grid that "
          "has grown keeps what it has. A run that fails is a result with its reason. At the end "
          "it writes runs.csv, tables, figures and report.html. --plan gives one command a run, "
          "for GNU parallel or Slurm (experiments/engines/); the same command without --plan then "
          "finishes.",
      .example = "duet study configs/studies/head_to_head.yaml --quick --jobs 2 --out h2h",
      .flags = {{.name = "out",
                 .value = "DIR",
                 .required = true,
                 .meaning = "Folder of the study; where it exists, what is in it is not done "
                            "again."},
                {.name = "quick"},
                {.name = "jobs",
                 .value = "N",
                 .meaning = "Runs at once, each a process. Costs a frame want 1."},
                {.name = "data", .value = "DIR", .without = "beside the study's file"},
                {.name = "dry-run"},
                {.name = "plan"},
                {.name = "run", .value = "ID"},
                {.name = "quiet"}},
      .operands = "FILE",
      .run = RunStudyCommand};
}

}  // namespace duet
