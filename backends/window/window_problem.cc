#include "backends/window/window_problem.h"

#include <ceres/product_manifold.h>
#include <ceres/solver.h>

#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

ceres::Problem::Options ProblemOptions(ParameterArena* arena) {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.evaluation_callback = arena;
  options.disable_all_safety_checks = true;
  return options;
}

// Of (theta, p), or of (theta, p, v).
std::unique_ptr<ceres::Manifold> MakePoseManifold(bool with_velocity) {
  if (with_velocity) {
    return std::make_unique<ceres::ProductManifold<RotationManifold, ceres::EuclideanManifold<6>>>(
        RotationManifold(), ceres::EuclideanManifold<6>());
  }
  return std::make_unique<ceres::ProductManifold<RotationManifold, ceres::EuclideanManifold<3>>>(
      RotationManifold(), ceres::EuclideanManifold<3>());
}

// The next cost of a pool; the pool grows where it is used up.
template <class Cost>
Cost* Next(std::vector<std::unique_ptr<Cost>>* pool, std::size_t* used) {
  if (*used == pool->size()) pool->push_back(std::make_unique<Cost>());
  return (*pool)[(*used)++].get();
}

}  // namespace

std::unique_ptr<ceres::LossFunction> MakeLoss(const WindowOptions& options) {
  switch (options.robust_loss) {
    case WindowOptions::RobustLoss::kNone:
      return nullptr;
    case WindowOptions::RobustLoss::kHuber:
      return std::make_unique<ceres::HuberLoss>(options.loss_width_sigmas);
    case WindowOptions::RobustLoss::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(options.loss_width_sigmas);
  }
  return nullptr;
}

WindowProblem::WindowProblem(const WindowOptions& options, const ReprojectionSetup& reprojection,
                             const StandstillOptions& standstill, const CalibrationLayout& layout)
    : options_(options),
      layout_(layout),
      arena_(layout, reprojection.off_instant),
      pose_(MakePoseManifold(reprojection.off_instant)),
      loss_(MakeLoss(options)) {
  for (const CalibrationGroup& group : arena_.groups()) {
    groups_.push_back(group.has_rotation ? std::make_unique<CalibrationManifold>(group) : nullptr);
  }
  context_.arena = &arena_;
  context_.layout = &layout;
  context_.reprojection = reprojection;
  context_.standstill = standstill;
  context_.inverse_depth_only =
      options.landmark_parameters == WindowOptions::LandmarkParameters::kInverseDepthOnly;
}

void WindowProblem::AddParameters(const std::vector<Landmark>& landmarks) {
  for (int i = 0; i < frame_count_; ++i) {
    problem_->AddParameterBlock(arena_.pose(i), pose_->AmbientSize(), pose_.get());
    if (!arena_.pose_with_velocity()) problem_->AddParameterBlock(arena_.velocity(i), 3);
    problem_->AddParameterBlock(arena_.biases(i), 6);
  }
  for (int g = 0; g < static_cast<int>(arena_.groups().size()); ++g) {
    problem_->AddParameterBlock(arena_.group(g), arena_.groups()[g].ambient_size, groups_[g].get());
  }
  int index = 0;
  for (const Landmark& landmark : landmarks) {
    if (!landmark.in_problem) continue;
    Eigen::Map<Eigen::Vector3d>(arena_.landmark(index)) = landmark.value;
    const CostBlock block{CostBlock::Kind::kLandmark, index++};
    problem_->AddParameterBlock(BlockMemory(block, context_), BlockSize(block, context_));
  }
}

void WindowProblem::Build(const std::vector<WindowFrame>& frames, const RigCalibration& rig,
                          const std::vector<Landmark>& landmarks, const WindowPrior& prior) {
  frame_count_ = static_cast<int>(frames.size());
  landmark_count_ = 0;
  for (const Landmark& landmark : landmarks) landmark_count_ += landmark.in_problem ? 1 : 0;
  arena_.Resize(frame_count_, landmark_count_);
  arena_.Pack(frames, rig);
  context_.frames = &frames;
  problem_ = std::make_unique<ceres::Problem>(ProblemOptions(&arena_));
  AddParameters(landmarks);

  prior_cost_.Reset(&context_, &prior, &blocks_);
  problem_->AddResidualBlock(&prior_cost_, nullptr, blocks_);

  std::size_t imu = 0;
  std::size_t standstill = 0;
  for (int i = 1; i < frame_count_; ++i) {
    if (frames[i].link) {
      ImuCost* cost = Next(&imu_costs_, &imu);
      cost->Reset(&context_, i, &blocks_);
      problem_->AddResidualBlock(cost, nullptr, blocks_);
    }
    if (frames[i].at_rest_since_before) {
      StandstillCost* cost = Next(&standstill_costs_, &standstill);
      cost->Reset(&context_, i, &blocks_);
      problem_->AddResidualBlock(cost, nullptr, blocks_);
    }
  }

  std::size_t used = 0;
  int index = 0;
  for (const Landmark& landmark : landmarks) {
    if (!landmark.in_problem) continue;
    for (const LandmarkObservation& o : landmark.observations) {
      if (context_.inverse_depth_only && IsAnchorPixel(landmark, o)) continue;
      ReprojectionCost* cost = Next(&reprojection_costs_, &used);
      cost->Reset(&context_, index, landmark.anchor(), o, &blocks_);
      problem_->AddResidualBlock(cost, loss_.get(), blocks_);
    }
    ++index;
  }
}

SolveSummary WindowProblem::Solve() {
  using Options = WindowOptions;
  ceres::Solver::Options options;
  options.trust_region_strategy_type = options_.trust_region == Options::TrustRegion::kDogleg
                                           ? ceres::DOGLEG
                                           : ceres::LEVENBERG_MARQUARDT;
  options.linear_solver_type = options_.linear_solver == Options::LinearSolver::kDenseSchur
                                   ? ceres::DENSE_SCHUR
                                   : ceres::SPARSE_SCHUR;
  options.max_num_iterations = options_.max_iterations;
  options.function_tolerance = options_.function_tolerance;
  options.gradient_tolerance = 1e-10;  // nothing to do: the first frame, data without noise
  options.parameter_tolerance = 0.0;
  // Damping is relative to the diagonal; directions that only the prior holds (position and yaw of
  // the whole window) are a millionth of it, and must move freely too.
  options.initial_trust_region_radius = 1e12;
  options.max_trust_region_radius = 1e18;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.minimizer_progress_to_stdout = false;
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (int l = 0; l < landmark_count_; ++l) {
    ordering->AddElementToGroup(BlockMemory({CostBlock::Kind::kLandmark, l}, context_), 0);
  }
  for (int i = 0; i < frame_count_; ++i) {
    ordering->AddElementToGroup(arena_.pose(i), 1);
    if (!arena_.pose_with_velocity()) ordering->AddElementToGroup(arena_.velocity(i), 1);
    ordering->AddElementToGroup(arena_.biases(i), 1);
  }
  for (int g = 0; g < static_cast<int>(arena_.groups().size()); ++g) {
    ordering->AddElementToGroup(arena_.group(g), 1);
  }
  options.linear_solver_ordering = ordering;

  ceres::Solver::Summary summary;
  ceres::Solve(options, problem_.get(), &summary);
  arena_.Unpack();
  SolveSummary result;
  // Where Ceres finds no step that lowers the cost (data without noise, at the last digit), what
  // was put in is kept; a cost that can't be evaluated is a failure.
  result.usable = summary.IsSolutionUsable() ||
                  (summary.initial_cost >= 0.0 && std::isfinite(summary.initial_cost));
  result.iterations = static_cast<int>(summary.iterations.size()) - 1;
  result.initial_cost = summary.initial_cost;
  result.final_cost = summary.final_cost;
  if (!result.usable) result.message = summary.message;
  VLOG(1) << "window solve: " << summary.BriefReport();
  VLOG(3) << summary.FullReport();
  return result;
}

void WindowProblem::Store(std::vector<WindowFrame>* frames, RigCalibration* rig,
                          std::vector<Landmark>* landmarks) {
  const WindowPoint& point = arena_.point();
  for (int i = 0; i < frame_count_; ++i) {
    (*frames)[i].state.nav = point.nav[i];
    (*frames)[i].state.biases = point.biases[i];
  }
  *rig = point.rig;
  int index = 0;
  for (Landmark& landmark : *landmarks) {
    if (!landmark.in_problem) continue;
    landmark.value = Eigen::Map<const Eigen::Vector3d>(arena_.landmark(index++));
  }
}

}  // namespace duet
