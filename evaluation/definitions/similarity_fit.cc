#include "evaluation/definitions/similarity_fit.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "common/support/logging.h"
#include "evaluation/alignment.h"

namespace duet {
namespace {

struct PositionMoments {
  Eigen::Vector3d mean_true = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();  // mean of true * est^T, about the means
  double variance_est = 0.0;
};

PositionMoments PositionMomentsOf(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                                  int poses) {
  CHECK_EQ(truth.size(), estimate.size());
  CHECK(!truth.empty());
  const std::size_t used =
      poses < 0 ? truth.size() : std::min(truth.size(), static_cast<std::size_t>(poses));
  const auto n = static_cast<double>(used);
  PositionMoments m;
  for (std::size_t i = 0; i < used; ++i) {
    m.mean_true += truth[i].p / n;
    m.mean_est += estimate[i].p / n;
  }
  for (std::size_t i = 0; i < used; ++i) {
    const Eigen::Vector3d d_est = estimate[i].p - m.mean_est;
    m.cross += (truth[i].p - m.mean_true) * d_est.transpose() / n;
    m.variance_est += d_est.squaredNorm() / n;
  }
  return m;
}

/// Maximizes trace(Rz^T M).
Eigen::Quaterniond NearestYaw(const Eigen::Matrix3d& M) {
  return YawRotation(std::atan2(M(1, 0) - M(0, 1), M(0, 0) + M(1, 1)));
}

}  // namespace

UmeyamaFit FitUmeyama(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                      bool with_scale, int poses) {
  const PositionMoments m = PositionMomentsOf(truth, estimate, poses);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;
  const Eigen::Matrix3d R_GE = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  UmeyamaFit fit{{Eigen::Quaterniond(R_GE).normalized()}, svd.singularValues()};
  if (with_scale) fit.similarity.scale = svd.singularValues().dot(sign) / m.variance_est;
  fit.similarity.p_GE = m.mean_true - fit.similarity.scale * (fit.similarity.R_GE * m.mean_est);
  return fit;
}

Similarity FitPositionYaw(const std::vector<Pose>& truth, const std::vector<Pose>& estimate,
                          int poses) {
  const PositionMoments m = PositionMomentsOf(truth, estimate, poses);
  Similarity similarity{NearestYaw(m.cross)};
  similarity.p_GE = m.mean_true - similarity.R_GE * m.mean_est;
  return similarity;
}

Similarity FitFirstPositionYaw(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  CHECK(!truth.empty() && !estimate.empty());
  const Eigen::Quaterniond difference = truth.front().R * estimate.front().R.conjugate();
  Similarity similarity{NearestYaw(difference.toRotationMatrix())};
  similarity.p_GE = truth.front().p - similarity.R_GE * estimate.front().p;
  return similarity;
}

Similarity FitFirstPose(const std::vector<Pose>& truth, const std::vector<Pose>& estimate) {
  CHECK(!truth.empty() && !estimate.empty());
  const Pose T_GE = truth.front() * estimate.front().Inverse();
  return {T_GE.R, T_GE.p};
}

}  // namespace duet
