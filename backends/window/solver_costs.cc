#include "backends/window/solver_costs.h"

#include "backends/window/imu_factor.h"
#include "common/geometry/so3.h"
#include "common/support/logging.h"

namespace duet {
namespace {

using Kind = CostBlock::Kind;

template <int kRows, int kCols>
using JacobianMap = Eigen::Map<Eigen::Matrix<double, kRows, kCols, Eigen::RowMajor>>;

// Writes d r / d pose's seven numbers from d r / d (theta, p).
template <int kRows, class Derived>
void WritePose(const Eigen::MatrixBase<Derived>& J, const ParameterArena::Lift& lift, double* out) {
  JacobianMap<kRows, 7> map(out);
  map.template leftCols<4>().noalias() = J.template leftCols<3>() * lift;
  map.template rightCols<3>() = J.template rightCols<3>();
}

// Writes d r / d a group's numbers from d r / d its error.
template <class Derived>
void WriteGroup(const Eigen::MatrixBase<Derived>& J, const CalibrationGroup& group,
                const SolverContext& context, double* out) {
  Eigen::Map<Eigen::Matrix<double, Derived::RowsAtCompileTime, Eigen::Dynamic, Eigen::RowMajor>>
      map(out, J.rows(), group.ambient_size);
  int number = 0;
  for (int e = group.first_entry; e < group.first_entry + group.entry_count; ++e) {
    const CalibrationLayout::Entry& entry = context.layout->entries()[e];
    const int component = entry.offset - group.offset;
    if (entry.block == CalibrationBlock::kExtrinsicRotation) {
      map.template middleCols<4>(number) =
          J.template middleCols<3>(component) * context.arena->calibration_lift(e);
      number += 4;
    } else {
      map.middleCols(number, entry.size) = J.middleCols(component, entry.size);
      number += entry.size;
    }
  }
}

// Declares the blocks to Ceres and lists their memory.
void Declare(const std::vector<CostBlock>& blocks, const SolverContext& context,
             std::vector<int>* sizes, std::vector<double*>* parameters) {
  sizes->clear();
  parameters->clear();
  for (const CostBlock& block : blocks) {
    sizes->push_back(BlockSize(block, context));
    parameters->push_back(BlockMemory(block, context));
  }
}

// The groups of the calibration that an IMU factor depends on, or a pixel.
void AddGroups(const SolverContext& context, bool of_imu, std::vector<CostBlock>* blocks) {
  const std::vector<CalibrationGroup>& groups = context.arena->groups();
  for (int g = 0; g < static_cast<int>(groups.size()); ++g) {
    if (IsImuBlock(context.layout->entries()[groups[g].first_entry].block) == of_imu) {
      blocks->push_back({Kind::kCalibration, g});
    }
  }
}

// The group that an entry of the layout belongs to.
int GroupOf(int entry, const SolverContext& context) {
  const std::vector<CalibrationGroup>& groups = context.arena->groups();
  int g = 0;
  while (entry >= groups[g].first_entry + groups[g].entry_count) ++g;
  return g;
}

}  // namespace

double* BlockMemory(const CostBlock& block, const SolverContext& context) {
  ParameterArena& arena = *context.arena;
  switch (block.kind) {
    case Kind::kPose:
      return arena.pose(block.index);
    case Kind::kVelocity:
      return arena.velocity(block.index);
    case Kind::kBiases:
      return arena.biases(block.index);
    case Kind::kCalibration:
      return arena.group(block.index);
    case Kind::kLandmark:
      return arena.landmark(block.index) + (context.inverse_depth_only ? 2 : 0);
  }
  LOG(FATAL) << "unknown kind of block";
  return nullptr;
}

int BlockSize(const CostBlock& block, const SolverContext& context) {
  switch (block.kind) {
    case Kind::kPose:
      return 7;
    case Kind::kVelocity:
      return 3;
    case Kind::kBiases:
      return 6;
    case Kind::kCalibration:
      return context.arena->groups()[block.index].ambient_size;
    case Kind::kLandmark:
      return context.inverse_depth_only ? 1 : 3;
  }
  LOG(FATAL) << "unknown kind of block";
  return 0;
}

void ReprojectionCost::Reset(const SolverContext* context, int landmark_index, int anchor,
                             const LandmarkObservation& observation,
                             std::vector<double*>* parameters) {
  context_ = context;
  landmark_ = context->arena->landmark(landmark_index);
  anchor_ = anchor;
  observation_ = observation;
  blocks_.clear();
  blocks_.push_back({Kind::kLandmark, landmark_index});
  // At its own instant the anchor's pose cancels in what the anchor's frame sees.
  const bool same = observation.frame == anchor;
  if (!same) blocks_.push_back({Kind::kPose, anchor});
  if (!same || context->reprojection.off_instant) {
    blocks_.push_back({Kind::kPose, observation.frame});
  }
  if (context->reprojection.off_instant) blocks_.push_back({Kind::kVelocity, observation.frame});
  AddGroups(*context, false, &blocks_);
  set_num_residuals(2);
  Declare(blocks_, *context, mutable_parameter_block_sizes(), parameters);
}

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  const ParameterArena& arena = *context_->arena;
  InverseDepth landmark = Eigen::Map<const Eigen::Vector3d>(landmark_);
  if (context_->inverse_depth_only) {
    landmark.z() = parameters[0][0];
  } else {
    landmark = Eigen::Map<const Eigen::Vector3d>(parameters[0]);
  }
  Eigen::Vector2d r;
  if (jacobians == nullptr) {
    if (!EvaluateReprojection(context_->reprojection, arena.point(), *context_->frames, anchor_,
                              observation_, landmark, &r)) {
      return false;
    }
    Eigen::Map<Eigen::Vector2d>{residuals} = r;
    return true;
  }

  ReprojectionJacobians J;
  if (!EvaluateReprojection(context_->reprojection, arena.point(), *context_->frames,
                            *context_->layout, anchor_, observation_, landmark, &r, &J)) {
    return false;
  }
  Eigen::Map<Eigen::Vector2d>{residuals} = r;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    if (jacobians[k] == nullptr) continue;
    const CostBlock& block = blocks_[k];
    switch (block.kind) {
      case Kind::kLandmark:
        if (context_->inverse_depth_only) {
          Eigen::Map<Eigen::Vector2d>{jacobians[k]} = J.landmark.col(2);
        } else {
          JacobianMap<2, 3>{jacobians[k]} = J.landmark;
        }
        break;
      case Kind::kPose: {
        Eigen::Matrix<double, 2, 6> J_pose = Eigen::Matrix<double, 2, 6>::Zero();
        if (block.index == anchor_) J_pose += J.anchor;
        if (block.index == observation_.frame) J_pose += J.state.leftCols<6>();
        WritePose<2>(J_pose, arena.frame_lift(block.index), jacobians[k]);
        break;
      }
      case Kind::kVelocity:
        JacobianMap<2, 3>{jacobians[k]} = J.state.rightCols<3>();
        break;
      case Kind::kCalibration: {
        const CalibrationGroup& group = arena.groups()[block.index];
        WriteGroup(J.calibration.middleCols(group.offset, group.size), group, *context_,
                   jacobians[k]);
        break;
      }
      case Kind::kBiases:
        break;
    }
  }
  return true;
}

void ImuCost::Reset(const SolverContext* context, int frame, std::vector<double*>* parameters) {
  context_ = context;
  frame_ = frame;
  blocks_.clear();
  for (const int f : {frame - 1, frame}) {
    blocks_.push_back({Kind::kPose, f});
    blocks_.push_back({Kind::kVelocity, f});
    blocks_.push_back({Kind::kBiases, f});
  }
  AddGroups(*context, true, &blocks_);
  set_num_residuals(15);
  Declare(blocks_, *context, mutable_parameter_block_sizes(), parameters);
}

bool ImuCost::Evaluate(double const* const* /*parameters*/, double* residuals,
                       double** jacobians) const {
  const ParameterArena& arena = *context_->arena;
  const WindowPoint& point = arena.point();
  const ImuLink& link = *(*context_->frames)[frame_].link;
  const int i = frame_ - 1;
  const int j = frame_;
  Vector15d r;
  ImuFactorJacobians J;
  EvaluateImuFactor(link.delta, point.nav[i], point.biases[i], point.nav[j], point.biases[j],
                    point.rig.imu, context_->reprojection.g_G, &r,
                    jacobians == nullptr ? nullptr : &J);
  const auto W = link.sqrt_information.triangularView<Eigen::Lower>();
  Eigen::Map<Vector15d>{residuals} = W * r;
  if (jacobians == nullptr) return true;

  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    if (jacobians[k] == nullptr) continue;
    const CostBlock& block = blocks_[k];
    const Matrix15d& J_state = block.index == i ? J.J_i : J.J_j;
    switch (block.kind) {
      case Kind::kPose: {
        const Eigen::Matrix<double, 15, 6> J_pose = W * J_state.middleCols<6>(kPoseOffset);
        WritePose<15>(J_pose, arena.frame_lift(block.index), jacobians[k]);
        break;
      }
      case Kind::kVelocity:
        JacobianMap<15, 3>{jacobians[k]} = W * J_state.middleCols<3>(kVelocityOffset);
        break;
      case Kind::kBiases:
        JacobianMap<15, 6>{jacobians[k]} = W * J_state.middleCols<6>(kBiasesOffset);
        break;
      case Kind::kCalibration: {
        const Eigen::Matrix<double, 15, Eigen::Dynamic, Eigen::ColMajor, 15, 27> J_T =
            W * J.J_T(Eigen::all, context_->layout->imu_columns());
        WriteGroup(J_T, arena.groups()[block.index], *context_, jacobians[k]);
        break;
      }
      case Kind::kLandmark:
        break;
    }
  }
  return true;
}

void StandstillCost::Reset(const SolverContext* context, int frame,
                           std::vector<double*>* parameters) {
  context_ = context;
  frame_ = frame;
  set_num_residuals(6);
  Declare({{Kind::kPose, frame - 1}, {Kind::kPose, frame}, {Kind::kVelocity, frame}}, *context,
          mutable_parameter_block_sizes(), parameters);
}

bool StandstillCost::Evaluate(double const* const* /*parameters*/, double* residuals,
                              double** jacobians) const {
  const ParameterArena& arena = *context_->arena;
  const int i = frame_ - 1;
  const int j = frame_;
  const StandstillResidual s =
      EvaluateStandstill(arena.point().nav[i], arena.point().nav[j], context_->standstill);
  const Eigen::Matrix<double, 6, 1> w = s.sigma.cwiseInverse();
  Eigen::Map<Eigen::Matrix<double, 6, 1>>{residuals} = w.cwiseProduct(s.r);
  if (jacobians == nullptr) return true;

  // s.J are those of the prediction h, the residual is z - h.
  const Eigen::Matrix<double, 6, 9> J_i = -(w.asDiagonal() * s.J_i);
  const Eigen::Matrix<double, 6, 9> J_j = -(w.asDiagonal() * s.J_j);
  if (jacobians[0] != nullptr) {
    WritePose<6>(J_i.leftCols<6>(), arena.frame_lift(i), jacobians[0]);
  }
  if (jacobians[1] != nullptr) {
    WritePose<6>(J_j.leftCols<6>(), arena.frame_lift(j), jacobians[1]);
  }
  if (jacobians[2] != nullptr) JacobianMap<6, 3>{jacobians[2]} = J_j.rightCols<3>();
  return true;
}

void PriorCost::Reset(const SolverContext* context, const WindowPrior* prior,
                      std::vector<double*>* parameters) {
  context_ = context;
  prior_ = prior;
  blocks_.clear();
  for (const PriorBlock& block : prior->blocks) {
    switch (block.kind) {
      case PriorBlock::Kind::kPose:
        blocks_.push_back({Kind::kPose, block.index});
        break;
      case PriorBlock::Kind::kVelocity:
        blocks_.push_back({Kind::kVelocity, block.index});
        break;
      case PriorBlock::Kind::kBiases:
        blocks_.push_back({Kind::kBiases, block.index});
        break;
      case PriorBlock::Kind::kCalibration: {
        const CostBlock group{Kind::kCalibration, GroupOf(block.index, *context)};
        const bool new_group = blocks_.empty() || blocks_.back().kind != Kind::kCalibration ||
                               blocks_.back().index != group.index;
        if (new_group) blocks_.push_back(group);
        break;
      }
    }
  }
  set_num_residuals(static_cast<int>(prior->root.J.rows()));
  Declare(blocks_, *context, mutable_parameter_block_sizes(), parameters);
  deviation_.resize(prior->root.J.cols());
}

bool PriorCost::Evaluate(double const* const* /*parameters*/, double* residuals,
                         double** jacobians) const {
  const ParameterArena& arena = *context_->arena;
  const int frame_count = static_cast<int>(context_->frames->size());
  DeviationFromOrigin(*context_->frames, arena.point(), prior_->rig_origin, *context_->layout,
                      &window_deviation_);
  int column = 0;
  for (const PriorBlock& block : prior_->blocks) {
    deviation_.segment(column, block.size) =
        window_deviation_.segment(WindowColumn(block, frame_count, *context_->layout), block.size);
    column += block.size;
  }
  const Eigen::MatrixXd& J = prior_->root.J;
  Eigen::Map<Eigen::VectorXd> r(residuals, J.rows());
  r = prior_->root.e;
  r.noalias() += J * deviation_;
  if (jacobians == nullptr) return true;

  // The true Jacobian of a rotation's deviation is the inverse left Jacobian.
  column = 0;
  std::size_t next = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const CostBlock& block = blocks_[k];
    if (block.kind == Kind::kCalibration) {
      const CalibrationGroup& group = arena.groups()[block.index];
      group_J_.setZero(J.rows(), group.size);
      for (; next < prior_->blocks.size(); ++next) {
        const PriorBlock& part = prior_->blocks[next];
        if (GroupOf(part.index, *context_) != block.index) break;
        const CalibrationLayout::Entry& entry = context_->layout->entries()[part.index];
        auto out = group_J_.middleCols(entry.offset - group.offset, entry.size);
        if (entry.block == CalibrationBlock::kExtrinsicRotation) {
          out.noalias() =
              J.middleCols<3>(column) * LeftJacobianInverse(deviation_.segment<3>(column));
        } else {
          out = J.middleCols(column, entry.size);
        }
        column += entry.size;
      }
      if (jacobians[k] != nullptr) WriteGroup(group_J_, group, *context_, jacobians[k]);
      continue;
    }
    const int first = column;
    const int size = prior_->blocks[next++].size;
    column += size;
    if (jacobians[k] == nullptr) continue;
    if (block.kind != Kind::kPose) {
      JacobianMap<Eigen::Dynamic, Eigen::Dynamic>(jacobians[k], J.rows(), size) =
          J.middleCols(first, size);
      continue;
    }
    const ParameterArena::Lift lift =
        LeftJacobianInverse(deviation_.segment<3>(first)) * arena.frame_lift(block.index);
    JacobianMap<Eigen::Dynamic, 7> map(jacobians[k], J.rows(), 7);
    map.leftCols<4>().noalias() = J.middleCols<3>(first) * lift;
    map.rightCols<3>() = J.middleCols<3>(first + 3);
  }
  return true;
}

}  // namespace duet
