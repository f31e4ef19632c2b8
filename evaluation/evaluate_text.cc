#include <algorithm>
#include <functional>
#include <utility>

#include "evaluation/evaluate.h"

namespace duet {
namespace {

using Cell = std::function<std::string(const TrajectoryEvaluation&)>;

void AddRow(const Evaluation& evaluation, std::string title, const Cell& cell, TextTable* table) {
  std::vector<std::string> row = {std::move(title)};
  for (const TrajectoryEvaluation& estimate : evaluation.estimates) row.push_back(cell(estimate));
  table->AddRow(std::move(row));
}

std::string MedianAndP95(const ErrorSummary& summary, int decimals) {
  if (summary.count == 0) return "-";
  return Number(summary.median, decimals) + " (" + Number(summary.p95, decimals) + ")";
}

bool TruthStands(const Evaluation& evaluation) {
  return std::any_of(evaluation.estimates.begin(), evaluation.estimates.end(),
                     [](const TrajectoryEvaluation& estimate) {
                       return estimate.absolute.alignment.refusal ==
                              AlignmentRefusal::kCoincidentTruth;
                     });
}

std::string OrientationTitle(AlignmentMode mode) {
  switch (mode) {
    case AlignmentMode::kPositionYaw:
      return "orientation rmse [deg] (yaw fitted to orientations)";
    case AlignmentMode::kSe3:
    case AlignmentMode::kSim3:
      return "orientation rmse [deg] (rotation fitted to orientations)";
    case AlignmentMode::kFirstPose:
      return "orientation rmse [deg] (first pose)";
    case AlignmentMode::kNone:
      return "orientation rmse [deg] (not aligned)";
  }
  return "";
}

void AddDriftRows(const Evaluation& evaluation, TextTable* table) {
  table->AddSection("drift from the own first pose (the truth stands still)");
  const auto drift = [&](const char* title, double Drift::*field, int decimals) {
    AddRow(
        evaluation, title,
        [&](const TrajectoryEvaluation& e) {
          return e.drift ? Number((*e.drift).*field, decimals) : "-";
        },
        table);
  };
  drift("  position, largest [m]", &Drift::position_max_m, 4);
  drift("  position, at the end [m]", &Drift::position_end_m, 4);
  drift("  orientation, largest [deg]", &Drift::orientation_max_deg, 3);
  AddRow(
      evaluation, "  the truth's own, largest [m]",
      [](const TrajectoryEvaluation& e) {
        return e.drift_true ? Number(e.drift_true->position_max_m, 4) : "-";
      },
      table);
}

void AddRelativeRows(const Evaluation& evaluation, TextTable* table) {
  // Estimates without any pair have the lengths too, with no segment.
  const TrajectoryEvaluation* any = nullptr;
  for (const TrajectoryEvaluation& e : evaluation.estimates) {
    if (!e.relative.empty() && !e.association.pairs.empty()) any = &e;
  }
  if (any == nullptr) return;
  table->AddSection("relative errors, median (p95), segments by the truth's travelled way");
  for (std::size_t i = 0; i < any->relative.size(); ++i) {
    const RelativeErrors& of_any = any->relative[i];
    const std::string title =
        "  " + Number(of_any.length_m, of_any.length_m < 1.0 ? 1 : 0) + " m: ";
    AddRow(
        evaluation, title + "translation [%], " + std::to_string(of_any.segments) + " segments",
        [&](const TrajectoryEvaluation& e) {
          return MedianAndP95(e.relative[i].translation_percent, 2);
        },
        table);
    AddRow(
        evaluation, title + "rotation [deg]",
        [&](const TrajectoryEvaluation& e) { return MedianAndP95(e.relative[i].rotation_deg, 3); },
        table);
  }
}

std::string Gaps(const Evaluation& evaluation, const TrajectoryEvaluation& estimate) {
  constexpr std::size_t kMostShown = 5;
  std::string text;
  const std::vector<TimeGap>& gaps = estimate.association.gaps;
  for (std::size_t i = 0; i < std::min(gaps.size(), kMostShown); ++i) {
    text += "  " + estimate.name + ": gap in the " +
            (gaps[i].cause == TimeGap::Cause::kTruth ? "truth" : "estimate") + " from " +
            Number(SecondsBetween(evaluation.start, gaps[i].start), 3) + " s to " +
            Number(SecondsBetween(evaluation.start, gaps[i].end), 3) + " s of the span\n";
  }
  if (gaps.size() > kMostShown) {
    text +=
        "  " + estimate.name + ": " + std::to_string(gaps.size() - kMostShown) + " further gaps\n";
  }
  return text;
}

}  // namespace

void AddAccuracyRows(const Evaluation& evaluation, TextTable* table) {
  const AlignmentMode mode = evaluation.options.alignment;
  table->AddSection(std::string("absolute errors, alignment ") + AlignmentModeName(mode));
  const auto summary = [&](std::string title, ErrorSummary AbsoluteErrors::*field,
                           double ErrorSummary::*number, int decimals) {
    AddRow(
        evaluation, std::move(title),
        [&](const TrajectoryEvaluation& e) {
          return Number((e.absolute.*field).*number, decimals);
        },
        table);
  };
  summary("  position rmse [m]", &AbsoluteErrors::position_m, &ErrorSummary::rmse, 4);
  summary("  position median [m]", &AbsoluteErrors::position_m, &ErrorSummary::median, 4);
  summary("  position largest [m]", &AbsoluteErrors::position_m, &ErrorSummary::max, 4);
  summary("  " + OrientationTitle(mode), &AbsoluteErrors::orientation_deg, &ErrorSummary::rmse, 3);
  summary("  tilt rmse [deg] (roll and pitch)", &AbsoluteErrors::tilt_deg, &ErrorSummary::rmse, 3);
  if (mode != AlignmentMode::kNone && mode != AlignmentMode::kFirstPose) {
    summary("  orientation rmse [deg] (rotation of the positions)",
            &AbsoluteErrors::orientation_by_positions_deg, &ErrorSummary::rmse, 3);
  }
  if (mode == AlignmentMode::kSim3) {
    AddRow(
        evaluation, "  scale of the estimate's metres",
        [](const TrajectoryEvaluation& e) {
          return e.absolute.alignment.alignment ? Number(e.absolute.alignment.alignment->scale, 5)
                                                : "-";
        },
        table);
  }
  if (TruthStands(evaluation)) AddDriftRows(evaluation, table);
  AddRelativeRows(evaluation, table);
}

void AddCoverageRows(const Evaluation& evaluation, TextTable* table) {
  table->AddSection("coverage of " + Number(evaluation.span_s(), 2) + " s");
  AddRow(
      evaluation, "  covered [s]",
      [](const TrajectoryEvaluation& e) { return Number(e.association.coverage_s, 2); }, table);
  AddRow(
      evaluation, "  covered [%]",
      [](const TrajectoryEvaluation& e) { return Number(100.0 * e.coverage_share, 1); }, table);
  AddRow(
      evaluation, "  poses with a truth / all",
      [](const TrajectoryEvaluation& e) {
        return std::to_string(e.association.pairs.size()) + " / " +
               std::to_string(e.association.estimate_count);
      },
      table);
  AddRow(
      evaluation, "  gaps",
      [](const TrajectoryEvaluation& e) { return std::to_string(e.association.gaps.size()); },
      table);
}

std::string EvaluationNotes(const Evaluation& evaluation) {
  std::string notes;
  for (const TrajectoryEvaluation& estimate : evaluation.estimates) {
    const AlignmentRefusal refusal = estimate.absolute.alignment.refusal;
    if (refusal != AlignmentRefusal::kNone) {
      notes +=
          "  " + estimate.name + ": no position error, " + AlignmentRefusalText(refusal) + "\n";
    }
    if (estimate.association.outside_truth > 0) {
      notes += "  " + estimate.name + ": " + std::to_string(estimate.association.outside_truth) +
               " poses before or after the truth\n";
    }
    notes += Gaps(evaluation, estimate);
  }
  if (evaluation.relative.dropped > 0) {
    notes += "  " + std::to_string(evaluation.relative.dropped) +
             " segments left out for all: one estimate has no pose near an end\n";
  }
  if (evaluation.truth_jumps > 0) {
    notes += "  the truth jumps " + std::to_string(evaluation.truth_jumps) +
             " times in the span; errors hold these steps\n";
  }
  if (!notes.empty()) notes = "Notes\n" + notes;
  notes +=
      "How to read: an error counts only with its coverage; what was skipped has no error. "
      "Position\n"
      "and orientation are aligned apart, each by its own fit. Relative errors need no alignment:\n"
      "the pose at a segment's start is taken as true.\n";
  if (evaluation.options.association.mode != AssociationMode::kInterpolated) {
    notes += std::string("Pairs are those of \"") +
             AssociationModeName(evaluation.options.association.mode) +
             "\" (nearest in time), for comparing with that program only.\n";
  }
  if (evaluation.options.alignment == AlignmentMode::kSim3) {
    notes += "sim3 takes the estimate's error of scale out: a diagnostic, no result.\n";
  }
  return notes;
}

std::string EvaluationText(const Evaluation& evaluation) {
  std::vector<std::string> header = {"truth: " + evaluation.truth_name};
  for (const TrajectoryEvaluation& e : evaluation.estimates) header.push_back(e.name);
  TextTable table(std::move(header));
  AddAccuracyRows(evaluation, &table);
  AddCoverageRows(evaluation, &table);
  return table.Text() + "\n" + EvaluationNotes(evaluation);
}

}  // namespace duet
