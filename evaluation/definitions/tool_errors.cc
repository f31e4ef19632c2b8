#include "evaluation/definitions/tool_errors.h"

#include <algorithm>
#include <array>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

struct ToolAlignmentName {
  Tool tool;
  ToolAlignment alignment;
  const char* name;
};
/// What each program has, its name for it; the first of a tool is taken where none is given.
constexpr std::array<ToolAlignmentName, 15> kToolAlignments = {{
    {Tool::kEvo, ToolAlignment::kSe3, "se3"},
    {Tool::kEvo, ToolAlignment::kSim3, "sim3"},
    {Tool::kEvo, ToolAlignment::kFirstPose, "origin"},
    {Tool::kEvo, ToolAlignment::kScale, "scale"},
    {Tool::kEvo, ToolAlignment::kNone, "none"},
    {Tool::kRpg, ToolAlignment::kPositionYaw, "posyaw"},
    {Tool::kRpg, ToolAlignment::kSe3, "se3"},
    {Tool::kRpg, ToolAlignment::kSim3, "sim3"},
    {Tool::kRpg, ToolAlignment::kNone, "none"},
    {Tool::kOvEval, ToolAlignment::kPositionYaw, "posyaw"},
    {Tool::kOvEval, ToolAlignment::kFirstPositionYaw, "posyawsingle"},
    {Tool::kOvEval, ToolAlignment::kSe3, "se3"},
    {Tool::kOvEval, ToolAlignment::kFirstPose, "se3single"},
    {Tool::kOvEval, ToolAlignment::kSim3, "sim3"},
    {Tool::kOvEval, ToolAlignment::kNone, "none"},
}};
constexpr std::array<Tool, 3> kTools = {Tool::kEvo, Tool::kRpg, Tool::kOvEval};

[[noreturn]] void ThrowDefinitionError(const std::string& expected, const std::string& got) {
  throw InputError("", 0, "--definition", "expected " + expected + ", got \"" + got + "\"");
}

Tool ParseTool(const std::string& name, const std::string& text) {
  for (const Tool tool : kTools) {
    if (name == ToolName(tool)) return tool;
  }
  ThrowDefinitionError("duet, evo, rpg, ov_eval or all", text);
}

ToolAlignment ParseToolAlignment(Tool tool, const std::string& name, const std::string& text) {
  std::string names;
  for (const ToolAlignmentName& known : kToolAlignments) {
    if (known.tool != tool) continue;
    if (name == known.name) return known.alignment;
    names += (names.empty() ? "" : ", ") + std::string(known.name);
  }
  ThrowDefinitionError("one of " + std::string(ToolName(tool)) + "'s alignments (" + names + ")",
                       text);
}

/// Whether the program can fit over the first poses only.
bool TakesPoses(const ToolDefinition& definition) {
  switch (definition.alignment) {
    case ToolAlignment::kSe3:
    case ToolAlignment::kSim3:
    case ToolAlignment::kScale:
    case ToolAlignment::kPositionYaw:
      return definition.tool != Tool::kOvEval;
    default:
      return false;
  }
}

}  // namespace

const char* ToolName(Tool tool) {
  switch (tool) {
    case Tool::kEvo:
      return "evo";
    case Tool::kRpg:
      return "rpg";
    case Tool::kOvEval:
      return "ov_eval";
  }
  return "";
}

std::string ToolDefinition::Name() const {
  std::string name = ToolName(tool);
  for (const ToolAlignmentName& known : kToolAlignments) {
    if (known.tool == tool && known.alignment == alignment) name += std::string(":") + known.name;
  }
  return poses < 0 ? name : name + ":" + std::to_string(poses);
}

std::optional<AlignmentMode> ToolDefinition::DuetAlignment() const {
  if (tool == Tool::kRpg && poses == 1 && alignment == ToolAlignment::kSe3) {
    return AlignmentMode::kFirstPose;
  }
  if (poses >= 0) return std::nullopt;
  switch (alignment) {
    case ToolAlignment::kNone:
      return AlignmentMode::kNone;
    case ToolAlignment::kFirstPose:
      return AlignmentMode::kFirstPose;
    case ToolAlignment::kPositionYaw:
      return AlignmentMode::kPositionYaw;
    case ToolAlignment::kSe3:
      return AlignmentMode::kSe3;
    case ToolAlignment::kSim3:
      return AlignmentMode::kSim3;
    case ToolAlignment::kFirstPositionYaw:
    case ToolAlignment::kScale:
      return std::nullopt;
  }
  return std::nullopt;
}

ToolDefinition ParseToolDefinition(const std::string& text) {
  const std::size_t first = text.find(':');
  ToolDefinition definition;
  definition.tool = ParseTool(text.substr(0, first), text);
  definition.alignment =
      std::find_if(kToolAlignments.begin(), kToolAlignments.end(),
                   [&](const ToolAlignmentName& known) { return known.tool == definition.tool; })
          ->alignment;
  if (first == std::string::npos) return definition;
  const std::size_t second = text.find(':', first + 1);
  definition.alignment =
      ParseToolAlignment(definition.tool, text.substr(first + 1, second - first - 1), text);
  if (second == std::string::npos) return definition;
  if (!TakesPoses(definition)) {
    ThrowDefinitionError("no number of poses (" + definition.Name() + " has none)", text);
  }
  const std::optional<std::int64_t> poses = ParseInt64(text.substr(second + 1));
  // rpg fits position and yaw, or SE(3), to one pose by its orientation; all else needs points.
  const bool one_will_do =
      definition.tool == Tool::kRpg && definition.alignment != ToolAlignment::kSim3;
  if (!poses || *poses < (one_will_do ? 1 : 2) || *poses > 1'000'000'000) {
    ThrowDefinitionError("a number of poses from " + std::string(one_will_do ? "1" : "2") + " on",
                         text);
  }
  definition.poses = static_cast<int>(*poses);
  return definition;
}

std::vector<ToolDefinition> AllToolDefinitions() {
  std::vector<ToolDefinition> definitions;
  for (const Tool tool : kTools) definitions.push_back(ParseToolDefinition(ToolName(tool)));
  return definitions;
}

ToolErrors EvaluateByTool(const std::vector<StampedPose>& truth,
                          const std::vector<StampedPose>& estimate,
                          const ToolDefinition& definition, std::span<const double> lengths_m) {
  switch (definition.tool) {
    case Tool::kEvo:
      return EvaluateLikeEvo(truth, estimate, definition, lengths_m);
    case Tool::kRpg:
      return EvaluateLikeRpg(truth, estimate, definition, lengths_m);
    case Tool::kOvEval:
      return EvaluateLikeOvEval(truth, estimate, definition, lengths_m);
  }
  return {};
}

}  // namespace duet
