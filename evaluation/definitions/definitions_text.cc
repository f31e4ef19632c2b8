#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "evaluation/definitions/definitions_report.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

using ToolCell = std::function<std::string(std::size_t tool)>;

void AddToolRow(const DefinitionComparison& comparison, std::string title, std::string of_duet,
                const ToolCell& cell, TextTable* table) {
  std::vector<std::string> row = {std::move(title), std::move(of_duet)};
  for (std::size_t i = 0; i < comparison.tools.size(); ++i) row.push_back(cell(i));
  table->AddRow(std::move(row));
}

std::string PercentFrom(double value, double reference) {
  const double percent = 100.0 * (value / reference - 1.0);
  const std::string number = Number(percent, 1);
  return number == "-" || number.front() == '-' ? number : "+" + number;
}

void AddPairRows(const TrajectoryEvaluation& duet, const DefinitionComparison& comparison,
                 const AssociationOptions& association, TextTable* table) {
  table->AddSection("pairs");
  const std::string of = " / " + std::to_string(duet.association.estimate_count);
  AddToolRow(
      comparison, "  pairs / poses of the estimate",
      std::to_string(duet.association.pairs.size()) + of,
      [&](std::size_t i) { return std::to_string(comparison.tools[i].matches.size()) + of; },
      table);
  AddToolRow(
      comparison, "  largest difference of stamps [ms]",
      association.mode == AssociationMode::kInterpolated ? "0.0" : "-",
      [&](std::size_t i) {
        return Number(1e3 * comparison.tools[i].largest_stamp_difference_s, 1);
      },
      table);
  AddToolRow(
      comparison, "  poses paired again",
      association.mode == AssociationMode::kInterpolated ? "0" : "-",
      [&](std::size_t i) { return std::to_string(comparison.tools[i].poses_matched_again); },
      table);
}

void AddAbsoluteRows(const TrajectoryEvaluation& duet, const DefinitionComparison& comparison,
                     TextTable* table) {
  const std::vector<ToolErrors>& tools = comparison.tools;
  const std::vector<AbsoluteErrors>& alike = comparison.duet_aligned_alike;
  const auto summary = [&](const char* title, ErrorSummary AbsoluteErrors::*of_duet,
                           double ErrorSummary::*number, ToolSummary ToolErrors::*of_tool,
                           double ToolSummary::*tool_number, int decimals) {
    AddToolRow(
        comparison, title, Number(duet.absolute.*of_duet.*number, decimals),
        [&](std::size_t i) { return Number(tools[i].*of_tool.*tool_number, decimals); }, table);
  };
  constexpr auto kPosition = &AbsoluteErrors::position_m;
  constexpr auto kOrientation = &AbsoluteErrors::orientation_deg;
  table->AddSection("absolute errors");
  summary("  position rmse [m]", kPosition, &ErrorSummary::rmse, &ToolErrors::position_m,
          &ToolSummary::rmse, 4);
  AddToolRow(
      comparison, "    from duet's [%]", "",
      [&](std::size_t i) {
        return PercentFrom(tools[i].position_m.rmse, duet.absolute.position_m.rmse);
      },
      table);
  AddToolRow(
      comparison, "    duet's, aligned alike [m]", "",
      [&](std::size_t i) { return Number(alike[i].position_m.rmse, 4); }, table);
  AddToolRow(
      comparison, "    from that, by the pairs alone [%]", "",
      [&](std::size_t i) {
        return PercentFrom(tools[i].position_m.rmse, alike[i].position_m.rmse);
      },
      table);
  summary("  position median [m]", kPosition, &ErrorSummary::median, &ToolErrors::position_m,
          &ToolSummary::median, 4);
  summary("  position largest [m]", kPosition, &ErrorSummary::max, &ToolErrors::position_m,
          &ToolSummary::max, 4);
  summary("  orientation rmse [deg]", kOrientation, &ErrorSummary::rmse,
          &ToolErrors::orientation_deg, &ToolSummary::rmse, 3);
  AddToolRow(
      comparison, "    duet's, turned as the positions [deg]",
      Number(duet.absolute.orientation_by_positions_deg.rmse, 3),
      [&](std::size_t i) { return Number(alike[i].orientation_by_positions_deg.rmse, 3); }, table);
  summary("  orientation median [deg]", kOrientation, &ErrorSummary::median,
          &ToolErrors::orientation_deg, &ToolSummary::median, 3);
}

std::string RelativeCell(double metres, double degrees, int segments) {
  if (segments == 0) return "-";
  return Number(metres, 4) + " / " + Number(degrees, 3) + " (" + std::to_string(segments) + ")";
}

std::string RelativeCell(const ToolRelativeErrors& relative) {
  return RelativeCell(relative.translation_m.median, relative.rotation_deg.median,
                      relative.segments);
}

void AddCommonLengths(const TrajectoryEvaluation& duet, const DefinitionComparison& comparison,
                      TextTable* table) {
  if (duet.relative.empty()) return;
  table->AddSection("relative errors, median [m] / [deg] (segments)");
  for (const RelativeErrors& of_duet : duet.relative) {
    AddToolRow(
        comparison, "  " + Number(of_duet.length_m, of_duet.length_m < 1.0 ? 1 : 0) + " m",
        RelativeCell(of_duet.translation_m.median, of_duet.rotation_deg.median, of_duet.segments),
        [&](std::size_t i) -> std::string {
          for (const ToolRelativeErrors& relative : comparison.tools[i].relative) {
            if (!relative.own_default && relative.all_pairs && relative.delta == of_duet.length_m) {
              return RelativeCell(relative);
            }
          }
          return "-";
        },
        table);
  }
}

/// What the programs give without being asked for a length, and evo's consecutive segments.
void AddOwnLengths(const DefinitionComparison& comparison, TextTable* table) {
  table->AddSection("relative errors as the programs choose, median [m] / [deg] (segments)");
  std::vector<Tool> told;
  for (const ToolErrors& tool : comparison.tools) {
    if (std::find(told.begin(), told.end(), tool.definition.tool) != told.end()) continue;
    told.push_back(tool.definition.tool);
    for (const ToolRelativeErrors& row : tool.relative) {
      if (!row.own_default && row.all_pairs) continue;
      const std::string length =
          row.in_frames ? Number(row.delta, 0) + " frame"
                        : Number(row.delta, row.delta == std::round(row.delta) ? 0 : 2) + " m";
      AddToolRow(
          comparison,
          std::string("  ") + ToolName(tool.definition.tool) + ": " + length +
              (row.all_pairs ? "" : ", consecutive"),
          "",
          [&](std::size_t i) -> std::string {
            const ToolErrors& of_column = comparison.tools[i];
            if (of_column.definition.tool != tool.definition.tool) return "";
            for (const ToolRelativeErrors& relative : of_column.relative) {
              if (relative.delta == row.delta && relative.in_frames == row.in_frames &&
                  relative.all_pairs == row.all_pairs && relative.own_default == row.own_default) {
                return RelativeCell(relative);
              }
            }
            return "-";
          },
          table);
    }
  }
}

const char* WhyToolDiffers(Tool tool) {
  switch (tool) {
    case Tool::kEvo:
      return "evo pairs each pose of the shorter trajectory with the nearest within 10 ms, a pose\n"
             "    possibly twice; chooses segments on the estimate's own way; its orientation "
             "error "
             "is turned\n    by the fit to the positions.\n";
    case Tool::kRpg:
      return "rpg pairs the nearest within 20 ms, the closest first; measures way in straight "
             "lines "
             "between\n    paired poses; after a gap it takes wrong starts for its segments; "
             "orientation as evo.\n";
    case Tool::kOvEval:
      return "ov_eval pairs a true pose with the first of the estimate's within 20 ms, not the "
             "nearest, and\n    overwrites its stamp; segments end within 0.5 m of their length; "
             "orientation as evo.\n";
  }
  return "";
}

std::string WhyTheyDiffer(const DefinitionComparison& comparison, AlignmentMode mode) {
  std::string text = "Why they differ\n";
  text += std::string("  duet interpolates the truth at the estimate's stamps, fits ") +
          AlignmentModeName(mode) +
          " to positions and to orientations apart,\n    and chooses segments on the whole truth, "
          "the same for all estimates.\n";
  std::vector<Tool> told;
  for (const ToolErrors& tool : comparison.tools) {
    if (!tool.refused.empty()) {
      text += "  " + tool.definition.Name() + ": no errors, " + tool.refused + "\n";
    }
    if (std::find(told.begin(), told.end(), tool.definition.tool) != told.end()) continue;
    told.push_back(tool.definition.tool);
    text += std::string("  ") + WhyToolDiffers(tool.definition.tool);
  }
  return text;
}

}  // namespace

std::vector<DefinitionComparison> CompareDefinitions(
    const NamedTrajectory& truth, const std::vector<NamedTrajectory>& estimates,
    const Evaluation& evaluation, const std::vector<ToolDefinition>& definitions) {
  std::vector<DefinitionComparison> comparisons;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const TrajectoryEvaluation& duet = evaluation.estimates.at(i);
    std::vector<double> lengths_m;
    for (const RelativeErrors& relative : duet.relative) lengths_m.push_back(relative.length_m);
    DefinitionComparison comparison{.estimate = estimates[i].name};
    for (const ToolDefinition& definition : definitions) {
      comparison.tools.push_back(
          EvaluateByTool(truth.poses, estimates[i].poses, definition, lengths_m));
      const auto mode = definition.DuetAlignment();
      comparison.duet_aligned_alike.push_back(
          mode ? ComputeAbsoluteErrors(duet.association.pairs, *mode,
                                       evaluation.options.alignment_options)
               : ComputeAbsoluteErrors({}, AlignmentMode::kNone));
    }
    comparisons.push_back(std::move(comparison));
  }
  return comparisons;
}

std::string DefinitionsText(const Evaluation& evaluation,
                            const std::vector<DefinitionComparison>& comparisons) {
  std::string text;
  for (std::size_t i = 0; i < comparisons.size(); ++i) {
    const DefinitionComparison& comparison = comparisons[i];
    const TrajectoryEvaluation& duet = evaluation.estimates.at(i);
    std::vector<std::string> header = {
        comparison.estimate,
        std::string("duet:") + AlignmentModeName(evaluation.options.alignment)};
    for (const ToolErrors& tool : comparison.tools) header.push_back(tool.definition.Name());
    TextTable table(std::move(header));
    AddPairRows(duet, comparison, evaluation.options.association, &table);
    AddAbsoluteRows(duet, comparison, &table);
    AddCommonLengths(duet, comparison, &table);
    AddOwnLengths(comparison, &table);
    text += table.Text() + "\n" + WhyTheyDiffer(comparison, evaluation.options.alignment);
    if (i + 1 < comparisons.size()) text += "\n";
  }
  return text;
}

}  // namespace duet
