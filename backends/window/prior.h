#pragma once

#include <Eigen/Core>
#include <vector>

#include "backends/estimator.h"
#include "backends/window/marginalization.h"
#include "backends/window/window_state.h"

namespace duet {

/// A part of the window's error that a prior speaks of.
struct PriorBlock {
  enum class Kind { kPose, kVelocity, kBiases, kCalibration };
  Kind kind;
  int index;  ///< of the window's frame, or of CalibrationLayout::entries()
  int size;
};

/// What is known of the window from all that left it, as the residual J d + e of unit variance,
/// where d is how far the blocks lie from their fixed origins: WindowFrame::origin for frames (the
/// first estimates), `rig_origin` for the calibration; errors as in DESIGN.md section 3.
struct WindowPrior {
  std::vector<PriorBlock> blocks;
  SquareRootForm root;
  RigCalibration rig_origin;
};

/// First component of a block in the error of a window with `frame_count` frames.
[[nodiscard]] int WindowColumn(const PriorBlock& block, int frame_count,
                               const CalibrationLayout& layout);

/// How far `point` lies from the origins, over the whole window's error; zero for parts that are in
/// no prior.
void DeviationFromOrigin(const std::vector<WindowFrame>& frames, const WindowPoint& point,
                         const RigCalibration& rig_origin, const CalibrationLayout& layout,
                         Eigen::VectorXd* deviation);

/// The first prior: frame 0's whole state as `initial` says and the calibration with its layout's
/// standard deviations, at `rig`. A variance of zero is taken as 1e-18.
[[nodiscard]] WindowPrior StartPrior(const InitialCondition& initial, const RigCalibration& rig,
                                     const CalibrationLayout& layout);

/// The prior of a quadratic over the whole window's error about the origins; blocks without
/// information are left out.
[[nodiscard]] WindowPrior PriorFromInformation(const InformationForm& form, int frame_count,
                                               const RigCalibration& rig_origin,
                                               const CalibrationLayout& layout);

/// Adds the prior's H = J'J and b = J'e, over the whole window's error about the origins.
void AddPrior(const WindowPrior& prior, int frame_count, const CalibrationLayout& layout,
              InformationForm* form);

}  // namespace duet
