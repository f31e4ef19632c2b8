#include "evaluation/alignment.h"

#include <Eigen/SVD>
#include <cmath>

#include "common/support/input_error.h"

namespace duet {
namespace {

constexpr int kMinPoses = 3;
/// The estimate's spread below this share of the truth's: it stands still.
constexpr double kMinSpreadRatio = 1e-6;
/// Width over length of the narrowest path that still determines a rotation about its own axis.
constexpr double kMinWidthRatio = 1e-3;
/// A fit of orientations whose resultant is below this share of its largest possible value.
constexpr double kMinResultant = 1e-9;

struct Moments {
  Eigen::Vector3d mean_true = Eigen::Vector3d::Zero();
  Eigen::Vector3d mean_est = Eigen::Vector3d::Zero();
  Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();     // mean of true * est^T, about the means
  Eigen::Vector3d var_true = Eigen::Vector3d::Zero();  // per axis
  Eigen::Vector3d var_est = Eigen::Vector3d::Zero();
};

Moments MomentsOf(const std::vector<PosePair>& pairs) {
  Moments m;
  const auto n = static_cast<double>(pairs.size());
  for (const PosePair& pair : pairs) {
    m.mean_true += pair.T_GB_true.p / n;
    m.mean_est += pair.T_EB.p / n;
  }
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d d_true = pair.T_GB_true.p - m.mean_true;
    const Eigen::Vector3d d_est = pair.T_EB.p - m.mean_est;
    m.cross += d_true * d_est.transpose() / n;
    m.var_true += d_true.cwiseAbs2() / n;
    m.var_est += d_est.cwiseAbs2() / n;
  }
  return m;
}

AlignmentResult Refuse(AlignmentRefusal refusal) { return {std::nullopt, refusal}; }

/// The yaw that maximizes trace(Rz(yaw)^T M): M's part in the plane is all that counts.
struct YawFit {
  double yaw;
  double resultant;  // the maximum, less M(2, 2)
};
YawFit BestYaw(const Eigen::Matrix3d& M) {
  const double cosine = M(0, 0) + M(1, 1);
  const double sine = M(1, 0) - M(0, 1);
  return {std::atan2(sine, cosine), std::hypot(sine, cosine)};
}

AlignmentResult AlignPositionYaw(const Moments& m, const AlignmentOptions& options) {
  const double spread_true = std::sqrt(m.var_true.head<2>().sum());
  const double spread_est = std::sqrt(m.var_est.head<2>().sum());
  if (std::sqrt(m.var_true.sum()) < options.min_spread_m) {
    return Refuse(AlignmentRefusal::kCoincidentTruth);
  }
  if (std::sqrt(m.var_est.sum()) <= kMinSpreadRatio * std::sqrt(m.var_true.sum())) {
    return Refuse(AlignmentRefusal::kCoincidentEstimate);
  }
  if (spread_true < options.min_spread_m || spread_est <= kMinSpreadRatio * spread_true) {
    return Refuse(AlignmentRefusal::kRotationUndetermined);
  }
  const YawFit fit = BestYaw(m.cross);
  if (fit.resultant <= kMinResultant * spread_true * spread_est) {
    return Refuse(AlignmentRefusal::kRotationUndetermined);
  }
  Alignment alignment{.mode = AlignmentMode::kPositionYaw, .R_GE = YawRotation(fit.yaw)};
  alignment.p_GE = m.mean_true - alignment.R_GE * m.mean_est;
  return {alignment, AlignmentRefusal::kNone};
}

AlignmentResult AlignUmeyama(const Moments& m, AlignmentMode mode,
                             const AlignmentOptions& options) {
  const double spread_true = std::sqrt(m.var_true.sum());
  if (spread_true < options.min_spread_m) return Refuse(AlignmentRefusal::kCoincidentTruth);
  if (std::sqrt(m.var_est.sum()) <= kMinSpreadRatio * spread_true) {
    return Refuse(AlignmentRefusal::kCoincidentEstimate);
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m.cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& d = svd.singularValues();
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0) sign.z() = -1.0;
  // A rotation about the first axis changes the sum by d2 + sign * d3 times (1 - cos): zero where
  // the points lie on a line, and where a reflection fits as well as two rotations.
  if (d(1) + sign.z() * d(2) <= kMinWidthRatio * kMinWidthRatio * d(0)) {
    return Refuse(AlignmentRefusal::kRotationUndetermined);
  }
  const Eigen::Matrix3d R_GE = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  Alignment alignment{.mode = mode, .R_GE = Eigen::Quaterniond(R_GE).normalized()};
  if (mode == AlignmentMode::kSim3) alignment.scale = d.dot(sign) / m.var_est.sum();
  alignment.p_GE = m.mean_true - alignment.scale * (alignment.R_GE * m.mean_est);
  return {alignment, AlignmentRefusal::kNone};
}

/// Sum of R_GB_true R_EB^T: the rotation R_GE nearest to it is the least-squares one.
Eigen::Matrix3d SumOfErrors(const std::vector<PosePair>& pairs) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const PosePair& pair : pairs) {
    sum += (pair.T_GB_true.R * pair.T_EB.R.conjugate()).toRotationMatrix();
  }
  return sum;
}

}  // namespace

const char* AlignmentModeName(AlignmentMode mode) {
  switch (mode) {
    case AlignmentMode::kNone:
      return "none";
    case AlignmentMode::kFirstPose:
      return "first";
    case AlignmentMode::kPositionYaw:
      return "posyaw";
    case AlignmentMode::kSe3:
      return "se3";
    case AlignmentMode::kSim3:
      return "sim3";
  }
  return "";
}

AlignmentMode ParseAlignmentMode(const std::string& name) {
  for (const AlignmentMode mode :
       {AlignmentMode::kNone, AlignmentMode::kFirstPose, AlignmentMode::kPositionYaw,
        AlignmentMode::kSe3, AlignmentMode::kSim3}) {
    if (name == AlignmentModeName(mode)) return mode;
  }
  throw InputError("", 0, "--alignment",
                   "expected posyaw, se3, sim3, first or none, got \"" + name + "\"");
}

const char* AlignmentRefusalText(AlignmentRefusal refusal) {
  switch (refusal) {
    case AlignmentRefusal::kNone:
      return "";
    case AlignmentRefusal::kNoPairs:
      return "no estimated pose has a truth";
    case AlignmentRefusal::kTooFewPoses:
      return "fewer than three poses have a truth";
    case AlignmentRefusal::kCoincidentTruth:
      return "the truth stands still: see the drift from the first pose";
    case AlignmentRefusal::kCoincidentEstimate:
      return "the estimate stands still while the truth moves";
    case AlignmentRefusal::kRotationUndetermined:
      return "the path is a line: it does not determine a rotation";
  }
  return "";
}

AlignmentResult Align(const std::vector<PosePair>& pairs, AlignmentMode mode,
                      const AlignmentOptions& options) {
  if (pairs.empty()) return Refuse(AlignmentRefusal::kNoPairs);
  if (mode == AlignmentMode::kNone) return {Alignment{}, AlignmentRefusal::kNone};
  if (mode == AlignmentMode::kFirstPose) {
    const Pose T_GE = pairs.front().T_GB_true * pairs.front().T_EB.Inverse();
    return {Alignment{.mode = mode, .R_GE = T_GE.R, .p_GE = T_GE.p}, AlignmentRefusal::kNone};
  }
  if (pairs.size() < kMinPoses) return Refuse(AlignmentRefusal::kTooFewPoses);
  const Moments moments = MomentsOf(pairs);
  return mode == AlignmentMode::kPositionYaw ? AlignPositionYaw(moments, options)
                                             : AlignUmeyama(moments, mode, options);
}

std::optional<Eigen::Quaterniond> FitYawToOrientations(const std::vector<PosePair>& pairs) {
  const YawFit fit = BestYaw(SumOfErrors(pairs));
  if (fit.resultant <= kMinResultant * static_cast<double>(pairs.size())) return std::nullopt;
  return YawRotation(fit.yaw);
}

std::optional<Eigen::Quaterniond> FitRotationToOrientations(const std::vector<PosePair>& pairs) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(SumOfErrors(pairs),
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& d = svd.singularValues();
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0.0 ? -1.0 : 1.0;
  if (d(1) + sign * d(2) <= kMinResultant * static_cast<double>(pairs.size())) return std::nullopt;
  const Eigen::Matrix3d R_GE =
      svd.matrixU() * Eigen::Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
  return Eigen::Quaterniond(R_GE).normalized();
}

Eigen::Quaterniond YawRotation(double yaw) {
  return {std::cos(0.5 * yaw), 0.0, 0.0, std::sin(0.5 * yaw)};
}

double YawOf(const Eigen::Quaterniond& R) {
  // Of q and -q the one with w >= 0 has the shorter angle.
  const double sign = R.w() < 0.0 ? -1.0 : 1.0;
  return 2.0 * std::atan2(sign * R.z(), sign * R.w());
}

double TiltOf(const Eigen::Quaterniond& R) {
  // cos(tilt) = 1 - 2 (x^2 + y^2), so that sin(tilt / 2) = hypot(x, y): exact near zero.
  return 2.0 * std::atan2(std::hypot(R.x(), R.y()), std::hypot(R.z(), R.w()));
}

}  // namespace duet
