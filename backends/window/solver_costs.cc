#include "backends/window/solver_costs.h"

#include "backends/window/imu_factor.h"
#include "common/geometry/so3.h"
#include "common/support/logging.h"

namespace duet {
namespace {

using Kind = CostBlock::Kind;

template <int kRows, int kCols>
using JacobianMap = Eigen::Map<Eigen::Matrix<double, kRows, kCols, Eigen::RowMajor>>;

// Writes d r / d the numbers of a pose (with velocity) from d r / d (theta, p(, v)).
template <class Derived>
void WritePose(const Eigen::MatrixBase<Derived>& J, const ParameterArena::Lift& lift, double* out) {
  constexpr int kSize = Derived::ColsAtCompileTime;
  Eigen::Map<Eigen::Matrix<double, Derived::RowsAtCompileTime, kSize + 1, Eigen::RowMajor>> map(
      out, J.rows(), kSize + 1);
  map.template leftCols<4>().noalias() = J.template leftCols<3>() * lift;
  map.template rightCols<kSize - 3>() = J.template rightCols<kSize - 3>();
}

// Writes d r / d a group's numbers from d r / d its error.
template <class Derived>
void WriteGroup(const Eigen::MatrixBase<Derived>& J, const CalibrationGroup& group,
                const SolverContext& context, double* out) {
  Eigen::Map<Eigen::Matrix<double, Derived::RowsAtCompileTime, Eigen::Dynamic, Eigen::RowMajor>>
      map(out, J.rows(), group.ambient_size);
  for (const CalibrationGroup::Part& part : group.parts) {
    if (part.entry == CalibrationGroup::kFilling) {
      map.middleCols(part.number, part.size).setZero();
    } else if (part.is_rotation) {
      map.template middleCols<4>(part.number).noalias() =
          J.template middleCols<3>(part.component) * context.arena->calibration_lift(part.entry);
    } else {
      map.middleCols(part.number, part.size) = J.middleCols(part.component, part.size);
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
    if (groups[g].of_imu == of_imu) blocks->push_back({Kind::kCalibration, g});
  }
}

// A frame's pose and velocity: one block or two.
void AddPoseAndVelocity(const SolverContext& context, int frame, std::vector<CostBlock>* blocks) {
  if (context.arena->pose_with_velocity()) {
    blocks->push_back({Kind::kMotion, frame});
  } else {
    blocks->push_back({Kind::kPose, frame});
    blocks->push_back({Kind::kVelocity, frame});
  }
}

}  // namespace

double* BlockMemory(const CostBlock& block, const SolverContext& context) {
  ParameterArena& arena = *context.arena;
  switch (block.kind) {
    case Kind::kPose:
    case Kind::kMotion:
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
    case Kind::kMotion:
      return 10;
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

int ErrorSize(const CostBlock& block, const SolverContext& context) {
  switch (block.kind) {
    case Kind::kPose:
    case Kind::kMotion:
      return BlockSize(block, context) - 1;
    case Kind::kCalibration:
      return context.arena->groups()[block.index].tangent_size;
    case Kind::kVelocity:
    case Kind::kBiases:
    case Kind::kLandmark:
      return BlockSize(block, context);
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
  const bool off_instant = context->reprojection.off_instant;
  const Kind kind = off_instant ? Kind::kMotion : Kind::kPose;
  if (!same) blocks_.push_back({kind, anchor});
  if (!same || off_instant) blocks_.push_back({kind, observation.frame});
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
        WritePose(J_pose, arena.frame_lift(block.index), jacobians[k]);
        break;
      }
      case Kind::kMotion: {
        Eigen::Matrix<double, 2, 9> J_motion = Eigen::Matrix<double, 2, 9>::Zero();
        if (block.index == anchor_) J_motion.leftCols<6>() += J.anchor;
        if (block.index == observation_.frame) J_motion += J.state;
        WritePose(J_motion, arena.frame_lift(block.index), jacobians[k]);
        break;
      }
      case Kind::kCalibration: {
        const CalibrationGroup& group = arena.groups()[block.index];
        WriteGroup(J.calibration.middleCols(group.offset, group.size), group, *context_,
                   jacobians[k]);
        break;
      }
      case Kind::kVelocity:
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
    AddPoseAndVelocity(*context, f, &blocks_);
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
        WritePose(J_pose, arena.frame_lift(block.index), jacobians[k]);
        break;
      }
      case Kind::kMotion: {
        const Eigen::Matrix<double, 15, 9> J_motion = W * J_state.leftCols<9>();
        WritePose(J_motion, arena.frame_lift(block.index), jacobians[k]);
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
  blocks_.clear();
  // The velocity of the frame before is not measured.
  const bool with_velocity = context->arena->pose_with_velocity();
  blocks_.push_back({with_velocity ? Kind::kMotion : Kind::kPose, frame - 1});
  AddPoseAndVelocity(*context, frame, &blocks_);
  set_num_residuals(6);
  Declare(blocks_, *context, mutable_parameter_block_sizes(), parameters);
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
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    if (jacobians[k] == nullptr) continue;
    const CostBlock& block = blocks_[k];
    const Eigen::Matrix<double, 6, 9>& J = block.index == i ? J_i : J_j;
    switch (block.kind) {
      case Kind::kPose:
        WritePose(J.leftCols<6>(), arena.frame_lift(block.index), jacobians[k]);
        break;
      case Kind::kMotion:
        WritePose(J, arena.frame_lift(block.index), jacobians[k]);
        break;
      case Kind::kVelocity:
        JacobianMap<6, 3>{jacobians[k]} = J.rightCols<3>();
        break;
      case Kind::kBiases:
      case Kind::kCalibration:
      case Kind::kLandmark:
        break;
    }
  }
  return true;
}

void PriorCost::AddColumns(const CostBlock& block, int component, int size, bool is_rotation) {
  if (blocks_.empty() || blocks_.back().kind != block.kind || blocks_.back().index != block.index) {
    blocks_.push_back(block);
  }
  const int first = columns_.empty() ? 0 : columns_.back().first + columns_.back().size;
  columns_.push_back({blocks_.size() - 1, component, first, size, is_rotation});
}

void PriorCost::Reset(const SolverContext* context, const WindowPrior* prior,
                      std::vector<double*>* parameters) {
  context_ = context;
  prior_ = prior;
  blocks_.clear();
  columns_.clear();
  const bool one_block = context->arena->pose_with_velocity();
  const std::vector<CalibrationGroup>& groups = context->arena->groups();
  for (const PriorBlock& block : prior->blocks) {
    switch (block.kind) {
      case PriorBlock::Kind::kPose: {
        const CostBlock pose{one_block ? Kind::kMotion : Kind::kPose, block.index};
        AddColumns(pose, 0, 3, true);
        AddColumns(pose, 3, 3, false);
        break;
      }
      case PriorBlock::Kind::kVelocity:
        AddColumns({one_block ? Kind::kMotion : Kind::kVelocity, block.index}, one_block ? 6 : 0, 3,
                   false);
        break;
      case PriorBlock::Kind::kBiases:
        AddColumns({Kind::kBiases, block.index}, 0, 6, false);
        break;
      case PriorBlock::Kind::kCalibration:
        for (int g = 0; g < static_cast<int>(groups.size()); ++g) {
          for (const CalibrationGroup::Part& part : groups[g].parts) {
            if (part.entry != block.index) continue;
            AddColumns({Kind::kCalibration, g}, part.component, part.size, part.is_rotation);
          }
        }
        break;
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

  std::size_t next = 0;
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    const CostBlock& block = blocks_[k];
    block_J_.setZero(J.rows(), ErrorSize(block, *context_));
    for (; next < columns_.size() && columns_[next].block == k; ++next) {
      const Columns& c = columns_[next];
      if (c.is_rotation) {
        // The true Jacobian of a rotation's deviation is the inverse left Jacobian.
        block_J_.middleCols<3>(c.component).noalias() =
            J.middleCols<3>(c.first) * LeftJacobianInverse(deviation_.segment<3>(c.first));
      } else {
        block_J_.middleCols(c.component, c.size) = J.middleCols(c.first, c.size);
      }
    }
    if (jacobians[k] == nullptr) continue;
    switch (block.kind) {
      case Kind::kPose:
        WritePose(block_J_.leftCols<6>(), arena.frame_lift(block.index), jacobians[k]);
        break;
      case Kind::kMotion:
        WritePose(block_J_.leftCols<9>(), arena.frame_lift(block.index), jacobians[k]);
        break;
      case Kind::kCalibration:
        WriteGroup(block_J_, arena.groups()[block.index], *context_, jacobians[k]);
        break;
      case Kind::kVelocity:
      case Kind::kBiases:
      case Kind::kLandmark:
        JacobianMap<Eigen::Dynamic, Eigen::Dynamic>(jacobians[k], J.rows(), block_J_.cols()) =
            block_J_;
        break;
    }
  }
  return true;
}

}  // namespace duet
