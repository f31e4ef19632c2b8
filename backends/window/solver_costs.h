#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <vector>

#include "backends/window/parameter_arena.h"
#include "backends/window/prior.h"
#include "backends/window/reprojection_factor.h"
#include "backends/window/window_state.h"
#include "common/measurement/standstill.h"

namespace duet {

/// What all cost functions of a problem share. Residuals read the point that the arena unpacks
/// before each evaluation, not the pointers that Ceres passes: those show the same values.
struct SolverContext {
  ParameterArena* arena = nullptr;
  const std::vector<WindowFrame>* frames = nullptr;
  const CalibrationLayout* layout = nullptr;
  ReprojectionSetup reprojection;
  StandstillOptions standstill;
  bool inverse_depth_only = false;
};

/// A parameter block of a cost, and which columns of its Jacobian over errors belong to it.
struct CostBlock {
  /// kMotion: pose and velocity in one (ParameterArena).
  enum class Kind { kPose, kVelocity, kMotion, kBiases, kCalibration, kLandmark };
  Kind kind;
  int index;  ///< frame, group of the calibration, or landmark of the arena
};

/// Adds a block's memory and size to a cost function's lists.
[[nodiscard]] double* BlockMemory(const CostBlock& block, const SolverContext& context);
[[nodiscard]] int BlockSize(const CostBlock& block, const SolverContext& context);
/// Components of its error.
[[nodiscard]] int ErrorSize(const CostBlock& block, const SolverContext& context);

/// A pixel of a landmark (2 residuals). Pooled: Reset makes it another's.
class ReprojectionCost final : public ceres::CostFunction {
 public:
  /// Fills `parameters` with the blocks in the order of Evaluate.
  void Reset(const SolverContext* context, int landmark_index, int anchor,
             const LandmarkObservation& observation, std::vector<double*>* parameters);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const SolverContext* context_ = nullptr;
  const double* landmark_ = nullptr;
  int anchor_ = 0;
  LandmarkObservation observation_;
  std::vector<CostBlock> blocks_;
};

/// The IMU between a frame and the one before it (15 residuals).
class ImuCost final : public ceres::CostFunction {
 public:
  /// `frame` has a link; its delta must not change while the cost is in use.
  void Reset(const SolverContext* context, int frame, std::vector<double*>* parameters);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const SolverContext* context_ = nullptr;
  int frame_ = 0;
  std::vector<CostBlock> blocks_;
};

/// The standstill measurement between a frame and the one before it (6 residuals).
class StandstillCost final : public ceres::CostFunction {
 public:
  void Reset(const SolverContext* context, int frame, std::vector<double*>* parameters);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const SolverContext* context_ = nullptr;
  int frame_ = 0;
  std::vector<CostBlock> blocks_;
};

/// What is known from all that left the window (WindowPrior). Its Jacobian is the true one at the
/// evaluated point: for a rotation J times LeftJacobianInverse of the deviation.
class PriorCost final : public ceres::CostFunction {
 public:
  void Reset(const SolverContext* context, const WindowPrior* prior,
             std::vector<double*>* parameters);
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  /// Neighbouring columns of the prior's J, and where they belong.
  struct Columns {
    std::size_t block;  // of blocks_
    int component;      // of the block's error
    int first;          // of J
    int size;
    bool is_rotation;
  };
  /// The next columns of J, as components of a block's error.
  void AddColumns(const CostBlock& block, int component, int size, bool is_rotation);

  const SolverContext* context_ = nullptr;
  const WindowPrior* prior_ = nullptr;
  std::vector<CostBlock> blocks_;
  std::vector<Columns> columns_;              // in the order of the blocks
  mutable Eigen::VectorXd window_deviation_;  // scratch
  mutable Eigen::VectorXd deviation_;         // scratch
  mutable Eigen::MatrixXd block_J_;           // scratch
};

}  // namespace duet
