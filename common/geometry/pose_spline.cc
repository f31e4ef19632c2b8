#include "common/geometry/pose_spline.h"

#include <algorithm>
#include <array>
#include <string>

#include "common/geometry/banded_cholesky.h"
#include "common/geometry/interpolation.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"

namespace duet {
namespace {

constexpr int kDegree = 5;
constexpr int kOrder = kDegree + 1;
constexpr double kMaxGapKnots = 4.0;

using BasisCoefficients = std::array<std::array<double, kOrder>, kOrder>;

constexpr double Binomial(int n, int k) {
  double result = 1.0;
  for (int i = 1; i <= k; ++i) result = result * (n - k + i) / i;
  return result;
}

constexpr double Power(double x, int n) { return n == 0 ? 1.0 : x * Power(x, n - 1); }

// Row j: lambda_j(u) = sum_n c[j][n] u^n, the sum of the uniform B-spline's basis functions j ... 5
// (Qin, "General matrix representations for B-splines", 2000).
constexpr BasisCoefficients CumulativeBasis() {
  BasisCoefficients basis{};
  for (int s = 0; s < kOrder; ++s) {
    for (int n = 0; n < kOrder; ++n) {
      double sum = 0.0;
      for (int l = s; l < kOrder; ++l) {
        sum += Power(-1.0, l - s) * Binomial(kOrder, l - s) * Power(kDegree - l, kDegree - n);
      }
      basis[s][n] = Binomial(kDegree, n) * sum / 120.0;  // 5!
    }
  }
  for (int s = kOrder - 2; s >= 0; --s) {
    for (int n = 0; n < kOrder; ++n) basis[s][n] += basis[s + 1][n];
  }
  return basis;
}
constexpr BasisCoefficients kCumulative = CumulativeBasis();

struct Blend {
  std::array<double, kOrder> value, first, second;  // of lambda_j, by u
};

Blend BlendAt(double u) {
  Blend blend;
  for (int j = 0; j < kOrder; ++j) {
    const auto& c = kCumulative[j];
    blend.value[j] = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))));
    blend.first[j] = c[1] + u * (2.0 * c[2] + u * (3.0 * c[3] + u * (4.0 * c[4] + u * 5.0 * c[5])));
    blend.second[j] = 2.0 * c[2] + u * (6.0 * c[3] + u * (12.0 * c[4] + u * 20.0 * c[5]));
  }
  return blend;
}

void CheckPoses(const std::vector<StampedPose>& poses, double knot_spacing_s) {
  if (poses.size() < kOrder) {
    throw InputError("a spline needs at least 6 poses, got " + std::to_string(poses.size()));
  }
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Timestamp last = poses[i - 1].timestamp;
    const double gap_s = SecondsBetween(last, poses[i].timestamp);
    if (gap_s <= 0.0) {
      throw InputError("poses are not in order: " + std::to_string(poses[i].timestamp) +
                       " ns follows " + std::to_string(last) + " ns");
    }
    if (gap_s > kMaxGapKnots * knot_spacing_s) {
      throw InputError("no pose for " + std::to_string(gap_s) + " s after " + std::to_string(last) +
                       " ns; a spline with knots every " + std::to_string(knot_spacing_s) +
                       " s bridges four of them");
    }
  }
}

}  // namespace

// The linear problem behind both fits, factorized once: control points c (n x 3) that minimize
//   sum_k |sum_j B_kj c_j - y_k|^2 + weight sum_i |(D c)_i|^2
// with the basis B at the poses' instants and third differences D.
class ControlPointFit {
 public:
  struct Row {
    std::size_t control;  // the first of six
    std::array<double, kOrder> basis;
  };

  ControlPointFit(std::vector<Row> rows, std::size_t control_count, double weight)
      : rows_(std::move(rows)), weight_(weight), factor_(NormalMatrix(control_count)) {}

  // The control points for y (one row a pose) and wanted third differences of z (one row each).
  [[nodiscard]] Eigen::MatrixXd Solve(const Eigen::MatrixXd& y, const Eigen::MatrixXd& z) const {
    Eigen::MatrixXd c = Eigen::MatrixXd::Zero(z.rows() + 3, 3);
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      for (int j = 0; j < kOrder; ++j) {
        c.row(rows_[k].control + j) += rows_[k].basis[j] * y.row(k);
      }
    }
    for (Eigen::Index i = 0; i < z.rows(); ++i) {
      for (int j = 0; j < 4; ++j) c.row(i + j) += weight_ * kThirdDifference[j] * z.row(i);
    }
    factor_.SolveInPlace(c);
    return c;
  }

 private:
  static constexpr std::array<double, 4> kThirdDifference = {-1.0, 3.0, -3.0, 1.0};

  [[nodiscard]] Eigen::MatrixXd NormalMatrix(std::size_t control_count) const {
    const auto n = static_cast<Eigen::Index>(control_count);
    Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(kOrder, n);
    for (const Row& row : rows_) {
      for (int i = 0; i < kOrder; ++i) {
        for (int j = 0; j <= i; ++j) lower(i - j, row.control + j) += row.basis[i] * row.basis[j];
      }
    }
    for (Eigen::Index d = 0; d + 3 < n; ++d) {
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j <= i; ++j) {
          lower(i - j, d + j) += weight_ * kThirdDifference[i] * kThirdDifference[j];
        }
      }
    }
    return lower;
  }

  std::vector<Row> rows_;
  double weight_;
  BandedCholesky factor_;
};

PoseSpline PoseSpline::Fit(const std::vector<StampedPose>& poses, double knot_spacing_s,
                           double smoothing) {
  CHECK_GT(knot_spacing_s, 0.0);
  CHECK_GT(smoothing, 0.0);
  CheckPoses(poses, knot_spacing_s);
  PoseSpline spline;
  spline.start_ = poses.front().timestamp;
  spline.end_ = poses.back().timestamp;
  spline.knot_spacing_ = std::max<Timestamp>(1, ToNanoseconds(knot_spacing_s));
  const Timestamp span = spline.end_ - spline.start_;
  const auto segments =
      static_cast<std::size_t>((span + spline.knot_spacing_ - 1) / spline.knot_spacing_);
  const std::size_t control_count = segments + kDegree;
  spline.rotations_.resize(control_count);
  spline.positions_.resize(control_count);
  spline.increments_.resize(control_count);

  std::vector<ControlPointFit::Row> rows;
  rows.reserve(poses.size());
  for (const StampedPose& pose : poses) {
    const Place place = spline.PlaceOf(pose.timestamp);
    const Blend blend = BlendAt(place.u);
    ControlPointFit::Row row{place.control, blend.value};
    for (int j = 0; j + 1 < kOrder; ++j) row.basis[j] -= blend.value[j + 1];
    rows.push_back(row);
  }
  const double poses_per_knot = static_cast<double>(poses.size()) / static_cast<double>(segments);
  const ControlPointFit fit(std::move(rows), control_count, smoothing * poses_per_knot);
  spline.FitPositions(poses, fit);
  spline.FitRotations(poses, fit);
  return spline;
}

PoseSpline::Place PoseSpline::PlaceOf(Timestamp t) const {
  CHECK_GE(t, start_);
  CHECK_LE(t, end_);
  const Timestamp last = static_cast<Timestamp>(positions_.size()) - kOrder;
  const Timestamp segment = std::min((t - start_) / knot_spacing_, last);
  const Timestamp rest = t - start_ - segment * knot_spacing_;
  return {static_cast<std::size_t>(segment),
          static_cast<double>(rest) / static_cast<double>(knot_spacing_)};
}

void PoseSpline::UpdateIncrements() {
  for (std::size_t c = 1; c < rotations_.size(); ++c) {
    increments_[c] = Log(rotations_[c - 1].conjugate() * rotations_[c]);
  }
}

void PoseSpline::FitPositions(const std::vector<StampedPose>& poses, const ControlPointFit& fit) {
  // About the first pose: positions far from the origin keep their digits.
  const Eigen::Vector3d origin = poses.front().T_GB.p;
  Eigen::MatrixXd y(poses.size(), 3);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    y.row(k) = (poses[k].T_GB.p - origin).transpose();
  }
  const Eigen::MatrixXd c = fit.Solve(y, Eigen::MatrixXd::Zero(positions_.size() - 3, 3));
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    positions_[i] = origin + c.row(i).transpose();
  }
}

// Gauss-Newton on R_c <- Exp(delta_c) R_c, delta_c in G, with the derivative of the curve's global
// error by delta_c taken as the basis B_c(t) I. That is exact for equal control points and off by
// the angle between neighbours, so that the steps contract by about that angle; their fixed point
// has B' residual = 0.
void PoseSpline::FitRotations(const std::vector<StampedPose>& poses, const ControlPointFit& fit) {
  for (std::size_t c = 0; c < rotations_.size(); ++c) {
    // Control point c weighs most two knots before its number.
    const Timestamp t = start_ + (static_cast<Timestamp>(c) - 2) * knot_spacing_;
    const auto pose = InterpolatePose(poses, std::clamp(t, start_, end_), 1e18);
    rotations_[c] = pose->R.normalized();
  }
  UpdateIncrements();
  constexpr int kMaxIterations = 50;
  constexpr double kConvergedRad = 1e-12;
  Eigen::MatrixXd y(poses.size(), 3);
  Eigen::MatrixXd z(rotations_.size() - 3, 3);
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    for (std::size_t k = 0; k < poses.size(); ++k) {
      y.row(k) = Residual(poses[k]).head<3>().transpose();
    }
    for (std::size_t i = 0; i + 3 < rotations_.size(); ++i) {
      const Eigen::Vector3d third =
          increments_[i + 3] - 2.0 * increments_[i + 2] + increments_[i + 1];
      z.row(i) = -(rotations_[i + 1] * third).transpose();
    }
    const Eigen::MatrixXd delta = fit.Solve(y, z);
    for (std::size_t c = 0; c < rotations_.size(); ++c) {
      rotations_[c] = BoxPlus(rotations_[c], delta.row(c).transpose());
    }
    UpdateIncrements();
    if (delta.cwiseAbs().maxCoeff() < kConvergedRad) break;
  }
}

Kinematics PoseSpline::At(Timestamp t) const {
  const Place place = PlaceOf(t);
  const Blend blend = BlendAt(place.u);
  const double inverse_h = 1.0 / SecondsBetween(0, knot_spacing_);
  Kinematics k;
  k.T_GB.p = positions_[place.control];
  k.T_GB.R = rotations_[place.control];
  for (int j = 1; j < kOrder; ++j) {
    const std::size_t c = place.control + j;
    const Eigen::Vector3d step = positions_[c] - positions_[c - 1];
    k.T_GB.p += blend.value[j] * step;
    k.v_GB += (blend.first[j] * inverse_h) * step;
    k.a_G += (blend.second[j] * inverse_h * inverse_h) * step;
    const Eigen::Vector3d& d = increments_[c];
    const Eigen::Quaterniond A = ExpQuaternion(blend.value[j] * d);
    k.T_GB.R = k.T_GB.R * A;
    k.omega_B = A.conjugate() * k.omega_B + (blend.first[j] * inverse_h) * d;
  }
  k.T_GB.R.normalize();
  return k;
}

Vector6d PoseSpline::Residual(const StampedPose& pose) const {
  const Kinematics k = At(pose.timestamp);
  Vector6d residual;
  residual << BoxMinus(pose.T_GB.R, k.T_GB.R), pose.T_GB.p - k.T_GB.p;
  return residual;
}

}  // namespace duet
