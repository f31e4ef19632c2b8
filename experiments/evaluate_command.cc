#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/dataset/ground_truth.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "evaluation/definitions/definitions_report.h"
#include "evaluation/evaluate.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"

DEFINE_string(groundtruth, "", "The truth: a trajectory in EuRoC's form or TUM's.");
DEFINE_string(
    estimate, "",
    "An estimated trajectory in either form; further files may follow without the flag (duet "
    "observability: or a run's folder, for its states; one only).");
DEFINE_string(
    definition, "duet",
    "Whose errors to compute: duet, evo, rpg (rpg_trajectory_evaluation), ov_eval, or all; "
    "an alignment of that program may follow, and how many poses it is fitted over: "
    "evo:sim3, rpg:se3:100. Others than duet are shown beside duet's.");
DEFINE_string(json, "", "Write the evaluation to this file too; it must not exist yet.");

namespace duet {
namespace {

/// Those other than Duet's own, each once.
std::vector<ToolDefinition> DefinitionsAsked(const CommandLine& line) {
  std::vector<ToolDefinition> definitions;
  for (const std::string& text : line.All("definition")) {
    if (text == "duet") continue;
    const std::vector<ToolDefinition> asked =
        text == "all" ? AllToolDefinitions()
                      : std::vector<ToolDefinition>{ParseToolDefinition(text)};
    for (const ToolDefinition& definition : asked) {
      if (std::find(definitions.begin(), definitions.end(), definition) == definitions.end()) {
        definitions.push_back(definition);
      }
    }
  }
  return definitions;
}

int RunEvaluate(const CommandLine& line) {
  ConfigSources sources;
  const Configuration configuration = LoadConfiguration(line, &sources);
  const std::vector<ToolDefinition> definitions = DefinitionsAsked(line);
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
  const NamedTrajectory truth = {FLAGS_groundtruth, ReadTrajectoryFile(FLAGS_groundtruth).poses};
  const Evaluation evaluation = Evaluate(truth, estimates, configuration.evaluation.Options());
  RequireOverlap(evaluation);
  nlohmann::ordered_json json = EvaluationJson(evaluation);
  if (definitions.empty()) {
    std::fputs(EvaluationText(evaluation).c_str(), stdout);
  } else {
    const auto comparisons = CompareDefinitions(truth, estimates, evaluation, definitions);
    std::fputs(DefinitionsText(evaluation, comparisons).c_str(), stdout);
    AddDefinitionsJson(comparisons, &json);
  }
  if (!FLAGS_json.empty()) WriteTextFile(FLAGS_json, json.dump(2) + "\n");
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
          "segments. With --definition the same trajectories are also evaluated as evo, "
          "rpg_trajectory_evaluation or ov_eval do it, with a line on why their numbers differ "
          "(docs/evaluation.md).",
      .example =
          "duet evaluate --groundtruth data.csv --estimate a/trajectory.tum b/trajectory.tum",
      .flags = {{.name = "groundtruth", .value = "FILE", .required = true},
                {.name = "estimate", .value = "FILE", .required = true, .repeatable = true},
                {.name = "definition", .value = "NAME", .repeatable = true},
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
