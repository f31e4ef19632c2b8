#include "frontend/outlier_rejection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "common/geometry/so3.h"

namespace duet {
namespace {

constexpr std::size_t kFewest = 8;

// Sampson's distance of a pair from x_1' (t x) x_R = 0 in the planes z = 1, with x_R = R x_0 not
// normalized to z = 1: the turn between the frames is a few degrees.
double Distance(const Eigen::Vector3d& x_R, const Eigen::Vector3d& x_1, const Eigen::Vector3d& t) {
  const Eigen::Vector3d line_1 = t.cross(x_R);
  const Eigen::Vector3d line_0 = x_1.cross(t);
  const double squared = line_1.head<2>().squaredNorm() + line_0.head<2>().squaredNorm();
  return squared > 1e-18 ? x_1.dot(line_1) / std::sqrt(squared) : 0.0;
}

// The sum of squares truncated at the limit, over all pairs.
double Score(std::span<const RayPair> pairs, const std::vector<Eigen::Vector3d>& rotated,
             const Eigen::Vector3d& t, double limit) {
  double score = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double d = Distance(rotated[i], pairs[i].to, t);
    score += std::min(d * d, limit * limit);
  }
  return score;
}

Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& t) {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  Eigen::Index smallest = 0;
  t.cwiseAbs().minCoeff(&smallest);
  axis[smallest] = 1.0;
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.cross(axis).normalized();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

// One Gauss-Newton step on (delta, t's two) with Cauchy's weights of width `scale`. The derivative
// of the distance's denominator is left out: it multiplies the distance, which is small.
void RefineStep(std::span<const RayPair> pairs, std::vector<Eigen::Vector3d>* rotated, double scale,
                EpipolarMotion* motion) {
  const Eigen::Matrix<double, 3, 2> basis = TangentBasis(motion->t);
  Eigen::Matrix<double, 5, 5> H = Eigen::Matrix<double, 5, 5>::Zero();
  Eigen::Matrix<double, 5, 1> g = Eigen::Matrix<double, 5, 1>::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d& x_R = (*rotated)[i];
    const Eigen::Vector3d& x_1 = pairs[i].to;
    const Eigen::Vector3d line_1 = motion->t.cross(x_R);
    const Eigen::Vector3d line_0 = x_1.cross(motion->t);
    const double norm = std::sqrt(line_1.head<2>().squaredNorm() + line_0.head<2>().squaredNorm());
    if (norm < 1e-9) continue;
    const double d = x_1.dot(line_1) / norm;
    // x_1 . (t x (delta x x_R)) = delta . (x_R x (x_1 x t)); x_1 . (dt x x_R) = dt . (x_R x x_1).
    Eigen::Matrix<double, 5, 1> J;
    J.head<3>() = x_R.cross(line_0) / norm;
    J.tail<2>() = basis.transpose() * x_R.cross(x_1) / norm;
    const double weight = 1.0 / (1.0 + d * d / (scale * scale));
    H += weight * J * J.transpose();
    g += weight * d * J;
  }
  // Without parallax t is free; the damping (far below a track's weight) keeps it where it is.
  H.diagonal().array() += 1e-9 * static_cast<double>(pairs.size());
  const Eigen::Matrix<double, 5, 1> step = -H.ldlt().solve(g);
  const Eigen::Matrix3d R = Exp(step.head<3>());
  for (Eigen::Vector3d& x_R : *rotated) x_R = R * x_R;
  motion->delta = Log(Eigen::Matrix3d(R * Exp(motion->delta)));
  motion->t = (motion->t + basis * step.tail<2>()).normalized();
}

}  // namespace

EpipolarMotion FindEpipolarMotion(std::span<const RayPair> pairs, const Eigen::Matrix3d& R_C1C0,
                                  const EpipolarOptions& options, Random* random,
                                  std::vector<bool>* inlier) {
  EpipolarMotion motion;
  inlier->assign(pairs.size(), true);
  if (pairs.size() < kFewest) return motion;
  std::vector<Eigen::Vector3d> rotated(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) rotated[i] = R_C1C0 * pairs[i].from;

  const double threshold = options.threshold_px / options.focal_px;
  const int count = static_cast<int>(pairs.size());
  double best = Score(pairs, rotated, motion.t, 3.0 * threshold);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    const auto a = static_cast<std::size_t>(random->UniformInt(count));
    const auto b = static_cast<std::size_t>(random->UniformInt(count));
    const Eigen::Vector3d t = rotated[a].cross(pairs[a].to).cross(rotated[b].cross(pairs[b].to));
    const double norm = t.norm();
    if (a == b || norm < 1e-12) continue;
    const double score = Score(pairs, rotated, t / norm, 3.0 * threshold);
    if (score < best) {
      best = score;
      motion.t = t / norm;
    }
  }
  // From the width of the hypotheses down to that of the pixels' noise.
  for (int i = 0; i < 3; ++i) RefineStep(pairs, &rotated, threshold, &motion);
  for (int i = 0; i < 3; ++i) RefineStep(pairs, &rotated, 0.3 * threshold, &motion);

  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const bool fits = std::abs(Distance(rotated[i], pairs[i].to, motion.t)) <= threshold;
    (*inlier)[i] = fits;
    motion.inliers += fits ? 1 : 0;
  }
  motion.valid = static_cast<std::size_t>(motion.inliers) >= std::max(kFewest, pairs.size() / 2);
  if (!motion.valid) inlier->assign(pairs.size(), true);
  return motion;
}

}  // namespace duet
