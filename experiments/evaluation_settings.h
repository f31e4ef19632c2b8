#pragma once

#include <string>
#include <vector>

#include "common/config/config_sources.h"
#include "evaluation/evaluate.h"

namespace duet {

/// How results are evaluated (configuration `evaluation:`); what it means stands beside
/// EvaluationOptions.
struct EvaluationSettings {
  AlignmentMode alignment = AlignmentMode::kPositionYaw;
  AssociationMode association = AssociationMode::kInterpolated;
  double max_truth_gap_s = 0.06;
  double min_spread_m = 0.01;
  std::vector<double> relative_lengths_m;
  double nees_settle_s = 2.0;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Choice("alignment", &alignment,
             {{"posyaw", AlignmentMode::kPositionYaw},
              {"se3", AlignmentMode::kSe3},
              {"sim3", AlignmentMode::kSim3},
              {"first", AlignmentMode::kFirstPose},
              {"none", AlignmentMode::kNone}},
             {.doc = "What is fitted between estimate and truth before errors are taken: position "
                     "and yaw (what a VIO cannot know), SE(3), Sim(3) (a diagnostic of scale), the "
                     "first pose, or nothing."});
    v.Choice("association", &association,
             {{"interpolated", AssociationMode::kInterpolated},
              {"evo", AssociationMode::kEvoNearest},
              {"rpg", AssociationMode::kRpgNearest},
              {"ov_eval", AssociationMode::kOvEvalNearest}},
             {.doc = "How the truth at an estimate's stamp is found: interpolated, or as three "
                     "other programs pair. (duet evaluate --definition gives their errors.)"});
    v.Field("max_truth_gap_s", &max_truth_gap_s,
            {.doc = "The truth is not interpolated over more than this.",
             .unit = "s",
             .min = 1e-4,
             .max = 10});
    v.Field("min_spread_m", &min_spread_m,
            {.doc = "A truth that is spread less than this (root mean square) stands still: no "
                    "alignment is fitted to it.",
             .unit = "m",
             .min = 0,
             .max = 10});
    v.Field("relative_lengths_m", &relative_lengths_m,
            {.doc = "Lengths of the segments of relative errors; empty: of 0.5, 1, 2, 5, 10, ... m "
                    "the up to four longest that are at most half of the way.",
             .unit = "m",
             .min = 1e-3,
             .max = 1e6});
    v.Field("nees_settle_s", &nees_settle_s,
            {.doc = "NEES counts from this long after the first state; in duet montecarlo and duet "
                    "ablate --simulate the errors do too, ATE among them.",
             .unit = "s",
             .min = 0,
             .max = 1e3});
  }

  [[nodiscard]] EvaluationOptions Options() const {
    EvaluationOptions options;
    options.alignment = alignment;
    options.alignment_options.min_spread_m = min_spread_m;
    options.association.mode = association;
    options.association.max_truth_gap_s = max_truth_gap_s;
    options.relative.lengths_m = relative_lengths_m;
    return options;
  }
};

/// A setting of `evaluation:` that something has no use for, by its name there.
struct UnusedSetting {
  std::string name;
  std::string why;  ///< "in duet ablate, which ..."
};

/// Throws InputError where one of them is not its default. `values` are those in force.
void RequireEvaluationDefaults(const std::vector<ResolvedValue>& values,
                               const std::vector<UnusedSetting>& unused);

}  // namespace duet
