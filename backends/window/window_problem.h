#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <memory>
#include <string>
#include <vector>

#include "backends/window/parameter_arena.h"
#include "backends/window/prior.h"
#include "backends/window/solver_costs.h"
#include "backends/window/window_options.h"
#include "backends/window/window_state.h"
#include "common/geometry/rotation_manifold.h"

namespace duet {

/// What the solver did.
struct SolveSummary {
  bool usable = false;
  int iterations = 0;
  double initial_cost = 0.0;
  double final_cost = 0.0;
  std::string message;  ///< where it is not usable
};

/// The robust loss of the options over squared whitened residuals; null for none.
[[nodiscard]] std::unique_ptr<ceres::LossFunction> MakeLoss(const WindowOptions& options);

/// The least-squares problem of a window for Ceres:
///
///   min  |prior|^2 + sum over frames |IMU|^2 + |standstill|^2 + sum over pixels loss(|pixel|^2)
///
/// Its memory is kept from frame to frame: one arena for the parameters, pools of cost functions.
class WindowProblem {
 public:
  /// All arguments are kept by reference and must outlive the problem.
  WindowProblem(const WindowOptions& options, const ReprojectionSetup& reprojection,
                const StandstillOptions& standstill, const CalibrationLayout& layout);

  /// Lays out parameters and residuals of the frames, the landmarks with `in_problem` and the
  /// prior; values are copied in.
  void Build(const std::vector<WindowFrame>& frames, const RigCalibration& rig,
             const std::vector<Landmark>& landmarks, const WindowPrior& prior);

  [[nodiscard]] SolveSummary Solve();

  /// Copies the parameters back out.
  void Store(std::vector<WindowFrame>* frames, RigCalibration* rig,
             std::vector<Landmark>* landmarks);

  [[nodiscard]] ceres::Problem& problem() { return *problem_; }
  [[nodiscard]] ParameterArena& arena() { return arena_; }

 private:
  void AddParameters(const std::vector<Landmark>& landmarks);

  const WindowOptions& options_;
  const CalibrationLayout& layout_;
  ParameterArena arena_;
  SolverContext context_;
  std::unique_ptr<ceres::Manifold> pose_;
  std::vector<std::unique_ptr<ceres::Manifold>> groups_;  // null: flat
  std::unique_ptr<ceres::LossFunction> loss_;
  std::vector<std::unique_ptr<ReprojectionCost>> reprojection_costs_;  // pool
  std::vector<std::unique_ptr<ImuCost>> imu_costs_;                    // pool
  std::vector<std::unique_ptr<StandstillCost>> standstill_costs_;      // pool
  PriorCost prior_cost_;
  std::vector<double*> blocks_;  // scratch
  int frame_count_ = 0;
  int landmark_count_ = 0;
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace duet
