#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "evaluation/alignment.h"
#include "evaluation/definitions/similarity_fit.h"
#include "evaluation/definitions/stamp_matching.h"

namespace duet {

/// Errors of trajectories as three other programs define them, so that Duet's numbers can be laid
/// beside published ones and the difference be explained. What each does stands at its function
/// below; test/evaluation/data/other_tools_reference.py works it out a second time, from the
/// programs' sources, and the test compares. Nothing here decides anything in Duet.

enum class Tool {
  kEvo,     ///< evo: evo_ape, evo_rpe
  kRpg,     ///< rpg_trajectory_evaluation
  kOvEval,  ///< OpenVINS's ov_eval: error_singlerun, error_comparison
};
[[nodiscard]] const char* ToolName(Tool tool);  ///< "evo", "rpg", "ov_eval"

enum class ToolAlignment {
  kNone,
  kFirstPose,         ///< evo "origin" (--align_origin), ov_eval "se3single"
  kPositionYaw,       ///< rpg, ov_eval "posyaw"
  kFirstPositionYaw,  ///< ov_eval "posyawsingle"
  kSe3,               ///< "se3"; evo -a
  kSim3,              ///< "sim3"; evo -as
  kScale,             ///< evo -s alone: the scale of the Sim(3) fit, nothing moved
};

/// One program with one of its alignments.
struct ToolDefinition {
  Tool tool = Tool::kEvo;
  ToolAlignment alignment = ToolAlignment::kSe3;
  int poses = -1;  ///< used for the fit, from the first (evo --n_to_align, rpg n_aligned); -1: all

  /// "evo:se3", "rpg:posyaw:1": what ParseToolDefinition takes.
  [[nodiscard]] std::string Name() const;
  /// Duet's alignment of the same class over the same poses; nothing where it has none.
  [[nodiscard]] std::optional<AlignmentMode> DuetAlignment() const;
  bool operator==(const ToolDefinition&) const = default;
};

/// TOOL, TOOL:ALIGNMENT or TOOL:ALIGNMENT:POSES. Without an alignment: evo se3 (evo itself aligns
/// nothing unless told; -a is what is printed of estimators that start anywhere), rpg posyaw (what
/// its authors' tutorial prescribes for visual-inertial estimators; the program takes sim3 where no
/// eval_cfg.yaml tells it otherwise), ov_eval posyaw (it has no default). Throws InputError (key
/// "--definition") that names what there is.
[[nodiscard]] ToolDefinition ParseToolDefinition(const std::string& text);
/// The three with those alignments.
[[nodiscard]] std::vector<ToolDefinition> AllToolDefinitions();

/// What these programs tell of a list of errors. With `count` 0 all numbers are NaN (rpg and
/// ov_eval print zeros there, evo stops).
struct ToolSummary {
  int count = 0;
  double rmse = std::numeric_limits<double>::quiet_NaN();
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = std::numeric_limits<double>::quiet_NaN();
  /// Over n (evo, rpg) or n - 1 (ov_eval, which prints NaN for one value).
  double std = std::numeric_limits<double>::quiet_NaN();
  double min = std::numeric_limits<double>::quiet_NaN();
  double max = std::numeric_limits<double>::quiet_NaN();
  double p99_if_normal = std::numeric_limits<double>::quiet_NaN();  ///< ov_eval: mean + 2.326 std
};
struct NamedToolSummary {
  std::string name;
  ToolSummary summary;
};

/// Errors over segments of one length.
struct ToolRelativeErrors {
  double delta = 0.0;
  bool in_frames = false;    ///< delta in poses instead of metres
  bool all_pairs = true;     ///< a segment starts at every pose; else where the last one ended
  bool own_default = false;  ///< of the lengths that the program takes by itself
  int segments = 0;
  ToolSummary translation_m;
  ToolSummary rotation_deg;
  std::vector<NamedToolSummary> further;
};

struct ToolErrors {
  ToolDefinition definition;
  std::vector<StampMatch> matches;
  double largest_stamp_difference_s = 0.0;
  int poses_matched_again = 0;  ///< poses that are in more than one match, beyond the first
  std::string refused;          ///< why the program would stop; nothing below is set then
  Similarity alignment;
  ToolSummary position_m;
  ToolSummary orientation_deg;
  std::vector<NamedToolSummary> further;
  std::vector<ToolRelativeErrors> relative;
};

/// Dispatches to the functions below. `lengths_m` are evaluated besides the program's own lengths.
[[nodiscard]] ToolErrors EvaluateByTool(const std::vector<StampedPose>& truth,
                                        const std::vector<StampedPose>& estimate,
                                        const ToolDefinition& definition,
                                        std::span<const double> lengths_m);

/// evo (MichaelGrupp/evo; evo/core/: sync.py 0e935978893c, geometry.py 1962b69eda04, metrics.py
/// 01c1dd57a239, filters.py ec06cd615ff2; evo/main_ape.py and main_rpe.py 02608915cb92).
///
/// - Pairs: MatchLikeEvo, 0.01 s.
/// - Alignment of the paired poses: none, origin (first poses agree), se3, sim3, scale; se3, sim3
///   and scale over the first POSES pairs. Refused where the covariance of the positions has
///   rank 1.
/// - APE, E = T_EB^-1 T_GB_true: position |p_true - p|, orientation the angle of E; `further`:
///   "rotation_part" |R_E - I|_F and "full_transformation" |E - I|_F.
/// - RPE on the aligned poses, E = (T_i^-1 T_j)_true^-1 (T_i^-1 T_j)_est, the same four numbers.
///   Pairs (i, j) are chosen on the *estimate*, so that two estimators are measured over different
///   pieces of the truth:
///   1 frame, consecutive (evo_rpe's default);
///   L metres, all (-d L -u m --all_pairs): for each i the j whose way from i along the estimate is
///   nearest to L, where that is within 10 % of L;
///   L metres, consecutive (-d L -u m): a pose is kept where the way since the last one kept
///   reaches L, segments run between those: what lies before the first one kept is in none, and
///   each overshoots L by up to a step.
/// - A gap counts as the straight line over it.
[[nodiscard]] ToolErrors EvaluateLikeEvo(const std::vector<StampedPose>& truth,
                                         const std::vector<StampedPose>& estimate,
                                         const ToolDefinition& definition,
                                         std::span<const double> lengths_m);

/// rpg_trajectory_evaluation (uzh-rpg; src/rpg_trajectory_evaluation/: associate_timestamps.py
/// 749ce6e7161c, align_utils.py and trajectory_loading.py f0d1773cb79f, align_trajectory.py
/// 295ea5eb4c32, compute_trajectory_errors.py 2d29ae91ec9f, trajectory_utils.py fe8e0a0e2874,
/// trajectory.py 995e584d1971, results_writer.py be0922c63be9).
///
/// - Pairs: MatchLikeRpg, 0.02 s.
/// - Alignment of the positions: none, posyaw, se3, sim3 over the first POSES pairs; posyaw and se3
///   over one pair take its orientation.
/// - Position error |p_true - p|; orientation error the angle of R_EB R_GB_true^T with the rotation
///   that was fitted to the *positions*. `further`: "scale_percent", meant as the error of steps'
///   lengths, but np.diff is called with order 0, so that it is of distances from the origin:
///   100 | |p| / |p_true| - 1 |.
/// - Relative errors on the poses as they came, times the alignment's scale. A segment starts at
///   every pair and ends where the way along the *paired truth* is nearest to L, if less than 0.2 L
///   off. Starts without an end are left out of the list of ends, yet the place in that list is
///   taken for the start: after the first such start (a gap, not only the end of the run) all later
///   segments start too early and are longer than L. With fewer than two there are none.
///   L: 0.1, 0.2 ... 0.5 of the way along the whole truth, cut to centimetres.
/// - `further` of a segment: "translation_percent" and "rotation_deg_per_m" of L (not of the way),
///   and, of the error turned into the estimate's own frame, "yaw_deg" and "gravity_deg" (root of
///   pitch^2 + roll^2 of the Euler angles z y x).
[[nodiscard]] ToolErrors EvaluateLikeRpg(const std::vector<StampedPose>& truth,
                                         const std::vector<StampedPose>& estimate,
                                         const ToolDefinition& definition,
                                         std::span<const double> lengths_m);

/// ov_eval (rpng/open_vins; ov_eval/src/: alignment/AlignUtils.cpp 5d9fbeeb52f7,
/// alignment/AlignTrajectory.cpp e274c656324f, calc/ResultTrajectory.cpp d371eb189a3c and .h
/// 86c1971b37aa, utils/Statistics.h 74a63cf758f5, error_singlerun.cpp 0923323a4ed1).
///
/// - Pairs: MatchLikeOvEval, 0.02 s; the program stops with fewer than three.
/// - Alignment: none, posyaw, posyawsingle, se3, se3single, sim3, always over all pairs.
/// - Position and orientation errors as rpg's.
/// - Relative errors on the *aligned* poses (with sim3 therefore scaled). A segment starts at every
///   pair and ends where the way along the paired truth is nearest to L, if less than 0.5 m off,
///   whatever L. L: 8, 16, 24, 32, 40 m. The program prints their medians.
/// - Statistics: the standard deviation over n - 1; what it calls 99th percentile is mean + 2.326
///   std. (Early versions took the wrong two values for the median of an even number, 07fe6dd3d84f:
///   not reproduced.)
/// - NEES is not reproduced.
[[nodiscard]] ToolErrors EvaluateLikeOvEval(const std::vector<StampedPose>& truth,
                                            const std::vector<StampedPose>& estimate,
                                            const ToolDefinition& definition,
                                            std::span<const double> lengths_m);

}  // namespace duet
