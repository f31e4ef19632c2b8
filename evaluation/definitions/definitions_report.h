#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "evaluation/definitions/tool_errors.h"
#include "evaluation/evaluate.h"

namespace duet {

/// One estimate by several definitions, beside Duet's own.
struct DefinitionComparison {
  std::string estimate = {};  ///< its name in `evaluation`
  std::vector<ToolErrors> tools = {};
  /// One a tool: Duet's errors over Duet's pairs with the tool's alignment, so that what is left
  /// between the two is the pairing. `alignment` refused where Duet has none of its kind.
  std::vector<AbsoluteErrors> duet_aligned_alike = {};
};

/// Applies `definitions` to each estimate, over the lengths of Duet's own relative errors besides
/// the programs' own. `evaluation` is Evaluate(truth, estimates, ...).
[[nodiscard]] std::vector<DefinitionComparison> CompareDefinitions(
    const NamedTrajectory& truth, const std::vector<NamedTrajectory>& estimates,
    const Evaluation& evaluation, const std::vector<ToolDefinition>& definitions);

/// One table an estimate, one column a definition, Duet's first, and why they differ.
[[nodiscard]] std::string DefinitionsText(const Evaluation& evaluation,
                                          const std::vector<DefinitionComparison>& comparisons);

/// The numbers of one definition. Those that do not exist are null.
[[nodiscard]] nlohmann::ordered_json ToolErrorsJson(const ToolErrors& errors);

/// Adds `definitions`, an object with one entry a definition, to each estimate in `json`
/// (EvaluationJson).
void AddDefinitionsJson(const std::vector<DefinitionComparison>& comparisons,
                        nlohmann::ordered_json* json);

}  // namespace duet
