#include "backends/window/normal_equations.h"

#include <array>
#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

constexpr int kMaxFrames = 64;

}  // namespace

Eigen::Matrix3d LandmarkInverseCholesky(const Eigen::Matrix3d& V) {
  Eigen::Vector3d scale;
  for (int i = 0; i < 3; ++i) scale[i] = V(i, i) > 0.0 ? 1.0 / std::sqrt(V(i, i)) : 0.0;
  const Eigen::Matrix3d M = scale.asDiagonal() * V * scale.asDiagonal();
  Eigen::Matrix3d L = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      if (L(j, j) > 0.0) L(i, j) = (M(i, j) - L.row(i).head(j).dot(L.row(j).head(j))) / L(j, j);
    }
    const double pivot = M(i, i) - L.row(i).head(i).squaredNorm();
    if (pivot <= kRankTolerance) continue;
    L(i, i) = std::sqrt(pivot);
    inverse(i, i) = 1.0 / L(i, i);
    for (int j = 0; j < i; ++j) {
      inverse(i, j) = -(L.row(i).head(i) * inverse.col(j).head(i))(0, 0) / L(i, i);
    }
  }
  return inverse * scale.asDiagonal();
}

void LinearizeDepth(int anchor, std::span<const LinearObservation> observations, int frame_count,
                    const CalibrationLayout& layout, DepthRow* depth) {
  const int c = kFrameSize * frame_count;
  depth->diagonal = 0.0;
  depth->row.setZero(c + layout.size());
  Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
  for (const LinearObservation& o : observations) {
    V.noalias() += o.J.landmark.transpose() * o.J.landmark;
  }
  const Eigen::RowVector3d L_inverse = LandmarkInverseCholesky(V).row(2);
  if (L_inverse[2] == 0.0) return;
  depth->diagonal = 1.0 / L_inverse[2];
  for (const LinearObservation& o : observations) {
    const Eigen::Vector2d w = o.J.landmark * L_inverse.transpose();
    depth->row.segment<9>(kFrameSize * o.frame).noalias() += o.J.state.transpose() * w;
    depth->row.segment<6>(kFrameSize * anchor).noalias() += o.J.anchor.transpose() * w;
    depth->row.tail(layout.size()).noalias() += o.J.calibration.transpose() * w;
  }
}

NormalEquations::NormalEquations(int frame_count, const CalibrationLayout& layout)
    : layout_(&layout), frame_count_(frame_count), calibration_(kFrameSize * frame_count) {
  CHECK_LE(frame_count, kMaxFrames);
  const int n = calibration_ + layout.size();
  sum_.H.setZero(n, n);
  sum_.b.setZero(n);
}

void NormalEquations::AddImu(int i, int j, const Vector15d& r, const ImuFactorJacobians& J) {
  const int a = kFrameSize * i;
  const int b = kFrameSize * j;
  Eigen::MatrixXd& H = sum_.H;
  H.block<15, 15>(a, a).noalias() += J.J_i.transpose() * J.J_i;
  H.block<15, 15>(a, b).noalias() += J.J_i.transpose() * J.J_j;
  H.block<15, 15>(b, b).noalias() += J.J_j.transpose() * J.J_j;
  sum_.b.segment<15>(a).noalias() += J.J_i.transpose() * r;
  sum_.b.segment<15>(b).noalias() += J.J_j.transpose() * r;

  const std::vector<int>& imu_columns = layout_->imu_columns();
  if (imu_columns.empty()) return;
  const auto width = static_cast<Eigen::Index>(imu_columns.size());
  const int c = calibration_;  // the T matrices come first
  const Eigen::Matrix<double, 15, Eigen::Dynamic, Eigen::ColMajor, 15, 27> J_c =
      J.J_T(Eigen::all, imu_columns);
  H.block(a, c, 15, width).noalias() += J.J_i.transpose() * J_c;
  H.block(b, c, 15, width).noalias() += J.J_j.transpose() * J_c;
  H.block(c, c, width, width).noalias() += J_c.transpose() * J_c;
  sum_.b.segment(c, width).noalias() += J_c.transpose() * r;
}

void NormalEquations::AddStandstill(int i, int j, const StandstillResidual& residual) {
  // The measurement's Jacobians are those of the prediction h; the residual is z - h.
  const Eigen::Matrix<double, 6, 1> w = residual.sigma.cwiseInverse();
  const Eigen::Matrix<double, 6, 9> J_i = -(w.asDiagonal() * residual.J_i);
  const Eigen::Matrix<double, 6, 9> J_j = -(w.asDiagonal() * residual.J_j);
  const Eigen::Matrix<double, 6, 1> r = w.cwiseProduct(residual.r);
  const int a = kFrameSize * i;
  const int b = kFrameSize * j;
  sum_.H.block<9, 9>(a, a).noalias() += J_i.transpose() * J_i;
  sum_.H.block<9, 9>(a, b).noalias() += J_i.transpose() * J_j;
  sum_.H.block<9, 9>(b, b).noalias() += J_j.transpose() * J_j;
  sum_.b.segment<9>(a).noalias() += J_i.transpose() * r;
  sum_.b.segment<9>(b).noalias() += J_j.transpose() * r;
}

void NormalEquations::AddLandmark(int anchor, std::span<const LinearObservation> observations,
                                  bool velocities, bool inverse_depth_only) {
  if (velocities) {
    AddLandmarkOf<9>(anchor, observations, inverse_depth_only);
  } else {
    AddLandmarkOf<6>(anchor, observations, inverse_depth_only);
  }
}

template <int kSize>
void NormalEquations::AddLandmarkOf(int anchor, std::span<const LinearObservation> observations,
                                    bool inverse_depth_only) {
  using FrameRows = Eigen::Matrix<double, 2, kSize>;
  Eigen::MatrixXd& H = sum_.H;
  Eigen::VectorXd& b = sum_.b;
  // Pixels say nothing of the T matrices, which come first.
  const int skipped = static_cast<int>(layout_->imu_columns().size());
  const int c_size = layout_->size() - skipped;
  const int c = calibration_ + skipped;

  // Products of so few rows are quickest coefficient by coefficient (lazyProduct); the factor that
  // gives the rows is kept transposed, so that these lie next to one another.
  using FrameColumns = Eigen::Matrix<double, kSize, 2>;
  std::array<Eigen::Matrix<double, 3, kSize>, kMaxFrames> W;  // landmark x frame
  std::array<bool, kMaxFrames> seen{};
  Eigen::Matrix3d V = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b_l = Eigen::Vector3d::Zero();
  const auto see = [&](int frame) {
    if (!seen[frame]) W[frame].setZero();
    seen[frame] = true;
  };

  // What goes with the calibration is summed over all pixels at once: [J_l J_a | J_c r]' J_c.
  constexpr int kBefore = 9;
  const auto pixel_rows = 2 * static_cast<Eigen::Index>(observations.size());
  if (c_size > 0 && pixels_.rows() < pixel_rows) pixels_.resize(pixel_rows, kBefore + c_size + 1);
  Eigen::Index row = 0;

  see(anchor);
  FrameRows J_a = FrameRows::Zero();
  for (const LinearObservation& o : observations) {
    const int f = o.frame;
    see(f);
    Eigen::Matrix<double, 2, 3> J_l = o.J.landmark;
    if (inverse_depth_only) J_l.template leftCols<2>().setZero();
    const Eigen::Matrix<double, 3, 2> J_l_t = J_l.transpose();
    V.noalias() += J_l_t * J_l;
    b_l.noalias() += J_l_t * o.r;

    FrameRows J_f = o.J.state.template leftCols<kSize>();
    if (f == anchor) {
      J_f.template leftCols<6>() += o.J.anchor;
    } else {
      J_a.template leftCols<6>() = o.J.anchor;
      const FrameColumns J_a_t = J_a.transpose();
      W[anchor] += J_l_t.lazyProduct(J_a);
      H.block<kSize, kSize>(kFrameSize * anchor, kFrameSize * anchor) += J_a_t.lazyProduct(J_a);
      // The anchor is the first frame of its landmark, so this is the upper triangle.
      H.block<kSize, kSize>(kFrameSize * anchor, kFrameSize * f) += J_a_t.lazyProduct(J_f);
      b.segment<kSize>(kFrameSize * anchor) += J_a_t.lazyProduct(o.r);
    }
    const FrameColumns J_f_t = J_f.transpose();
    W[f] += J_l_t.lazyProduct(J_f);
    H.block<kSize, kSize>(kFrameSize * f, kFrameSize * f) += J_f_t.lazyProduct(J_f);
    b.segment<kSize>(kFrameSize * f) += J_f_t.lazyProduct(o.r);
    if (c_size > 0) {
      const auto J_c = o.J.calibration.rightCols(c_size);
      H.block(kFrameSize * f, c, kSize, c_size) += J_f_t.lazyProduct(J_c);
      auto rows = pixels_.middleRows<2>(row);
      rows.leftCols<3>() = J_l;
      if (f == anchor) {
        rows.middleCols<6>(3).setZero();
      } else {
        rows.middleCols<6>(3) = o.J.anchor;
      }
      rows.middleCols(kBefore, c_size) = J_c;
      rows.col(kBefore + c_size) = o.r;
      row += 2;
    }
  }

  // Schur complement of the landmark: with Y = L^-1 W, H -= Y'Y and b -= Y'(L^-1 b_l).
  const Eigen::Matrix3d L_inverse = LandmarkInverseCholesky(V);
  const Eigen::Vector3d y_l = L_inverse * b_l;
  for (int f = 0; f < frame_count_; ++f) {
    if (seen[f]) W[f] = L_inverse.lazyProduct(W[f]).eval();
  }
  for (int f = 0; f < frame_count_; ++f) {
    if (!seen[f]) continue;
    const Eigen::Matrix<double, kSize, 3> Y_t = W[f].transpose();
    for (int g = f; g < frame_count_; ++g) {
      if (!seen[g]) continue;
      H.block<kSize, kSize>(kFrameSize * f, kFrameSize * g) -= Y_t.lazyProduct(W[g]);
    }
    b.segment<kSize>(kFrameSize * f) -= Y_t.lazyProduct(y_l);
  }
  if (c_size == 0) return;

  const auto pixels = pixels_.topRows(row);
  products_.noalias() = pixels.transpose() * pixels.middleCols(kBefore, c_size);
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3,
                ReprojectionJacobians::kMaxCalibration>
      Y_c = L_inverse.lazyProduct(products_.topRows<3>());
  H.block(kFrameSize * anchor, c, 6, c_size) += products_.middleRows<6>(3);
  H.block(c, c, c_size, c_size) += products_.middleRows(kBefore, c_size);
  b.segment(c, c_size) += products_.bottomRows<1>().transpose();
  for (int f = 0; f < frame_count_; ++f) {
    if (!seen[f]) continue;
    const Eigen::Matrix<double, kSize, 3> Y_t = W[f].transpose();
    H.block(kFrameSize * f, c, kSize, c_size) -= Y_t.lazyProduct(Y_c);
  }
  H.block(c, c, c_size, c_size).noalias() -= Y_c.transpose() * Y_c;
  b.segment(c, c_size).noalias() -= Y_c.transpose() * y_l;
}

void NormalEquations::AddPrior(const WindowPrior& prior) {
  duet::AddPrior(prior, frame_count_, *layout_, &sum_);
}

InformationForm NormalEquations::Take() {
  sum_.H.triangularView<Eigen::StrictlyLower>() = sum_.H.transpose();
  return std::move(sum_);
}

}  // namespace duet
