#include <gflags/gflags.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/dataset/ground_truth.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "evaluation/evaluate.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"

DEFINE_string(groundtruth, "", "The truth: a trajectory in EuRoC's form or TUM's.");
DEFINE_string(
    estimate, "",
    "An estimated trajectory in either form; further files may follow without the flag (duet "
    "observability: or a run's folder, for its states; one only).");
DEFINE_string(json, "", "Write the evaluation to this file too; it must not exist yet.");

namespace duet {
namespace {

int RunEvaluate(const CommandLine& line) {
  ConfigSources sources;
  const Configuration configuration = LoadConfiguration(line, &sources);
  std::error_code ignored;
  if (!FLAGS_json.empty() && std::filesystem::exists(FLAGS_json, ignored)) {
    throw InputError(FLAGS_json, 0, "", "exists; --json expects a file that does not exist yet");
  }
  std::vector<std::string> files = line.All("estimate");
  files.insert(files.end(), line.operands().begin(), line.operands().end());
  std::vector<NamedTrajectory> estimates;
  for (const std::string& file : files) {
    estimates.push_back({file, ReadTrajectoryFile(file).poses});
  }
  const Evaluation evaluation =
      Evaluate({FLAGS_groundtruth, ReadTrajectoryFile(FLAGS_groundtruth).poses}, estimates,
               configuration.evaluation.Options());
  RequireOverlap(evaluation);
  std::fputs(EvaluationText(evaluation).c_str(), stdout);
  if (!FLAGS_json.empty()) WriteTextFile(FLAGS_json, EvaluationJson(evaluation).dump(2) + "\n");
  return kDone;
}

}  // namespace

Command EvaluateCommand() {
  Command command = {
      .name = "evaluate",
      .summary = "Evaluates trajectories against a truth.",
      .description =
          "Errors of any trajectories in TUM's form (t x y z qx qy qz qw) or EuRoC's against a "
          "truth: absolute position and orientation errors after the alignment asked for, relative "
          "errors over travelled distance, coverage. Several estimates are evaluated on the same "
          "segments.",
      .example =
          "duet evaluate --groundtruth data.csv --estimate a/trajectory.tum b/trajectory.tum",
      .flags = {{.name = "groundtruth", .value = "FILE", .required = true},
                {.name = "estimate", .value = "FILE", .required = true, .repeatable = true},
                {.name = "json", .value = "FILE"}},
      .operands = "[FILE...]",
      .run = RunEvaluate};
  for (const FlagUse& flag : CommonFlags(true)) {
    if (flag.name == "alignment" || flag.name == "config" || flag.name == "set") {
      command.flags.push_back(flag);
    }
  }
  return command;
}

}  // namespace duet
