#include "backends/window/prior.h"

#include <Eigen/Cholesky>

#include "common/support/logging.h"

namespace duet {
namespace {

// All blocks that a window's prior may speak of, in the order of the window's error.
std::vector<PriorBlock> AllBlocks(int frame_count, const CalibrationLayout& layout) {
  std::vector<PriorBlock> blocks;
  for (int i = 0; i < frame_count; ++i) {
    blocks.push_back({PriorBlock::Kind::kPose, i, 6});
    blocks.push_back({PriorBlock::Kind::kVelocity, i, 3});
    blocks.push_back({PriorBlock::Kind::kBiases, i, 6});
  }
  for (int e = 0; e < static_cast<int>(layout.entries().size()); ++e) {
    blocks.push_back({PriorBlock::Kind::kCalibration, e, layout.entries()[e].size});
  }
  return blocks;
}

}  // namespace

int WindowColumn(const PriorBlock& block, int frame_count, const CalibrationLayout& layout) {
  switch (block.kind) {
    case PriorBlock::Kind::kPose:
      return kFrameSize * block.index + kPoseOffset;
    case PriorBlock::Kind::kVelocity:
      return kFrameSize * block.index + kVelocityOffset;
    case PriorBlock::Kind::kBiases:
      return kFrameSize * block.index + kBiasesOffset;
    case PriorBlock::Kind::kCalibration:
      return kFrameSize * frame_count + layout.entries()[block.index].offset;
  }
  LOG(FATAL) << "unknown kind of block";
  return -1;
}

void DeviationFromOrigin(const std::vector<WindowFrame>& frames, const WindowPoint& point,
                         const RigCalibration& rig_origin, const CalibrationLayout& layout,
                         Eigen::VectorXd* deviation) {
  const int frame_count = static_cast<int>(frames.size());
  deviation->setZero(kFrameSize * frame_count + layout.size());
  for (int i = 0; i < frame_count; ++i) {
    const WindowFrame& frame = frames[i];
    auto d = deviation->segment<kFrameSize>(kFrameSize * i);
    if (frame.pose_in_prior) {
      d.segment<3>(0) = BoxMinus(point.nav[i].R_GB, frame.origin.nav.R_GB);
      d.segment<3>(3) = point.nav[i].p_GB - frame.origin.nav.p_GB;
    }
    if (frame.velocity_in_prior) d.segment<3>(6) = point.nav[i].v_GB - frame.origin.nav.v_GB;
    if (frame.biases_in_prior) {
      d.segment<3>(9) = point.biases[i].b_g - frame.origin.biases.b_g;
      d.segment<3>(12) = point.biases[i].b_a - frame.origin.biases.b_a;
    }
  }
  if (layout.size() > 0) deviation->tail(layout.size()) = BoxMinus(point.rig, rig_origin, layout);
}

WindowPrior StartPrior(const InitialCondition& initial, const RigCalibration& rig,
                       const CalibrationLayout& layout) {
  constexpr double kSmallestVariance = 1e-18;
  WindowPrior prior;
  prior.blocks = AllBlocks(1, layout);
  prior.rig_origin = rig;
  const int n = kFrameSize + layout.size();
  prior.root.J.setZero(n, n);
  prior.root.e.setZero(n);

  Matrix15d floored = initial.covariance;
  floored.diagonal() = floored.diagonal().cwiseMax(kSmallestVariance);
  const Eigen::LLT<Matrix15d> llt(floored);
  CHECK(llt.info() == Eigen::Success) << "the first covariance is not positive definite";
  Matrix15d J = Matrix15d::Identity();
  llt.matrixL().solveInPlace(J);
  prior.root.J.topLeftCorner<kFrameSize, kFrameSize>() = J;
  if (layout.size() > 0) {
    if (initial.calibration_gain.size() > 0) {
      prior.root.J.topRightCorner(kFrameSize, layout.size()) = -J * initial.calibration_gain;
    }
    prior.root.J.diagonal().tail(layout.size()) =
        layout.PriorSigmas().cwiseMax(std::sqrt(kSmallestVariance)).cwiseInverse();
  }
  return prior;
}

WindowPrior PriorFromInformation(const InformationForm& form, int frame_count,
                                 const RigCalibration& rig_origin,
                                 const CalibrationLayout& layout) {
  WindowPrior prior;
  prior.rig_origin = rig_origin;
  std::vector<int> columns;
  for (const PriorBlock& block : AllBlocks(frame_count, layout)) {
    const int first = WindowColumn(block, frame_count, layout);
    if (form.H.diagonal().segment(first, block.size).maxCoeff() <= 0.0) continue;
    prior.blocks.push_back(block);
    for (int k = 0; k < block.size; ++k) columns.push_back(first + k);
  }
  prior.root = TakeSquareRoot({form.H(columns, columns), form.b(columns)});
  return prior;
}

void AddPrior(const WindowPrior& prior, int frame_count, const CalibrationLayout& layout,
              InformationForm* form) {
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(prior.root.J.cols(), prior.root.J.cols());
  H.selfadjointView<Eigen::Upper>().rankUpdate(prior.root.J.transpose());
  H.triangularView<Eigen::StrictlyLower>() = H.transpose();
  const Eigen::VectorXd b = prior.root.J.transpose() * prior.root.e;
  int row = 0;
  for (const PriorBlock& a : prior.blocks) {
    const int to_row = WindowColumn(a, frame_count, layout);
    form->b.segment(to_row, a.size) += b.segment(row, a.size);
    int column = 0;
    for (const PriorBlock& c : prior.blocks) {
      form->H.block(to_row, WindowColumn(c, frame_count, layout), a.size, c.size) +=
          H.block(row, column, a.size, c.size);
      column += c.size;
    }
    row += a.size;
  }
}

}  // namespace duet
