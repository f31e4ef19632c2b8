#include "common/imu/inertial_truth_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "common/geometry/interpolation.h"
#include "common/geometry/so3.h"

namespace duet {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInterval_s = 0.05;  // over which rates are averaged
constexpr double kMaxShift_s = 0.1;
constexpr double kArm_s = 0.25;  // of the second differences

// The integral of a reading over time, trapezoids between samples.
class Integral {
 public:
  Integral(const std::vector<ImuSample>& imu, Vector3d ImuSample::*member)
      : imu_(imu), member_(member), sums_(imu.size(), Vector3d::Zero()) {
    for (std::size_t i = 1; i < imu.size(); ++i) {
      const double dt_s = SecondsBetween(imu[i - 1].timestamp, imu[i].timestamp);
      sums_[i] = sums_[i - 1] + 0.5 * dt_s * (imu[i - 1].*member + imu[i].*member);
    }
  }
  [[nodiscard]] bool Covers(Timestamp t0, Timestamp t1) const {
    return t0 >= imu_.front().timestamp && t1 <= imu_.back().timestamp;
  }
  [[nodiscard]] Vector3d To(Timestamp t) const {
    auto after = std::lower_bound(imu_.begin(), imu_.end(), t,
                                  [](const ImuSample& s, Timestamp u) { return s.timestamp < u; });
    if (after == imu_.begin()) return sums_.front();
    const auto before = after - 1;
    const double step_s = SecondsBetween(before->timestamp, after->timestamp);
    const double dt_s = SecondsBetween(before->timestamp, t);
    const Vector3d end = *before.*member_ + (dt_s / step_s) * (*after.*member_ - *before.*member_);
    return sums_[static_cast<std::size_t>(before - imu_.begin())] +
           0.5 * dt_s * (*before.*member_ + end);
  }

 private:
  const std::vector<ImuSample>& imu_;
  Vector3d ImuSample::*member_;
  std::vector<Vector3d> sums_;
};

struct RateInterval {
  Timestamp start;
  Timestamp end;
  Vector3d omega_truth;
  bool used = true;
};

std::vector<RateInterval> RatesOf(const std::vector<StampedPose>& truth) {
  std::vector<RateInterval> intervals;
  const Timestamp length = ToNanoseconds(kInterval_s);
  std::size_t begin = 0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Timestamp dt = truth[i].timestamp - truth[begin].timestamp;
    if (dt < length * 99 / 100) continue;
    if (dt < 2 * length) {
      intervals.push_back({truth[begin].timestamp, truth[i].timestamp,
                           Log(truth[begin].T_GB.R.conjugate() * truth[i].T_GB.R) *
                               (1e9 / static_cast<double>(dt))});
    }
    begin = i;
  }
  return intervals;
}

// The rotation and bias that fit best at one shift, and what is left.
struct RotationFit {
  Matrix3d R = Matrix3d::Identity();
  Vector3d bias = Vector3d::Zero();
  double mean_square = 1e300;
  double second_singular = 0.0;  // of the truth's scatter: sees whether two axes were turned about
};

RotationFit FitRotation(const Integral& gyro, const std::vector<RateInterval>& intervals,
                        Timestamp shift, std::vector<double>* residuals = nullptr) {
  std::vector<Vector3d> measured;
  std::vector<Vector3d> true_rates;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const RateInterval& interval = intervals[i];
    if (!interval.used || !gyro.Covers(interval.start + shift, interval.end + shift)) continue;
    measured.push_back((gyro.To(interval.end + shift) - gyro.To(interval.start + shift)) /
                       SecondsBetween(interval.start, interval.end));
    true_rates.push_back(interval.omega_truth);
    indices.push_back(i);
  }
  RotationFit fit;
  if (measured.size() < 20) return fit;
  const double count = static_cast<double>(measured.size());
  Vector3d mean_m = Vector3d::Zero();
  Vector3d mean_t = Vector3d::Zero();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    mean_m += measured[i] / count;
    mean_t += true_rates[i] / count;
  }
  Matrix3d cross = Matrix3d::Zero();
  Matrix3d scatter = Matrix3d::Zero();
  for (std::size_t i = 0; i < measured.size(); ++i) {
    cross += (measured[i] - mean_m) * (true_rates[i] - mean_t).transpose() / count;
    scatter += (true_rates[i] - mean_t) * (true_rates[i] - mean_t).transpose() / count;
  }
  const Eigen::JacobiSVD<Matrix3d> svd(cross, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3d D = Matrix3d::Identity();
  D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() > 0.0 ? 1.0 : -1.0;
  fit.R = svd.matrixU() * D * svd.matrixV().transpose();
  fit.bias = mean_m - fit.R * mean_t;
  fit.second_singular = Eigen::JacobiSVD<Matrix3d>(scatter).singularValues()[1];
  fit.mean_square = 0.0;
  if (residuals != nullptr) residuals->assign(intervals.size(), -1.0);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double square = (measured[i] - fit.R * true_rates[i] - fit.bias).squaredNorm();
    fit.mean_square += square / count;
    if (residuals != nullptr) (*residuals)[indices[i]] = std::sqrt(square);
  }
  return fit;
}

// The best shift: a coarse search, then golden sections.
double BestShift(const Integral& gyro, const std::vector<RateInterval>& intervals) {
  const auto cost = [&](double shift_s) {
    return FitRotation(gyro, intervals, ToNanoseconds(shift_s)).mean_square;
  };
  constexpr double kStep_s = 0.005;
  double best_s = 0.0;
  double best = cost(0.0);
  for (double shift_s = -kMaxShift_s; shift_s <= kMaxShift_s + 1e-9; shift_s += kStep_s) {
    const double value = cost(shift_s);
    if (value < best) {
      best = value;
      best_s = shift_s;
    }
  }
  double low_s = best_s - kStep_s;
  double high_s = best_s + kStep_s;
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0);
  while (high_s - low_s > 1e-5) {
    const double a = high_s - ratio * (high_s - low_s);
    const double b = low_s + ratio * (high_s - low_s);
    (cost(a) < cost(b) ? high_s : low_s) = cost(a) < cost(b) ? b : a;
  }
  return 0.5 * (low_s + high_s);
}

// Intervals far off (a jump of the truth lies in them) are left out; returns how many.
int LeaveOutliersOut(const std::vector<double>& residuals, std::vector<RateInterval>* intervals) {
  std::vector<double> known;
  for (const double r : residuals) {
    if (r >= 0.0) known.push_back(r);
  }
  if (known.empty()) return 0;
  std::nth_element(known.begin(), known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2),
                   known.end());
  const double bound = 6.0 * known[known.size() / 2];
  int count = 0;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (residuals[i] > bound) {
      (*intervals)[i].used = false;
      ++count;
    }
  }
  return count;
}

}  // namespace

std::optional<GyroTruthFit> FitGyroToTruth(const std::vector<ImuSample>& imu,
                                           const std::vector<StampedPose>& truth) {
  if (imu.size() < 2 || truth.size() < 2) return std::nullopt;
  std::vector<RateInterval> intervals = RatesOf(truth);
  const Integral gyro(imu, &ImuSample::omega_m);
  GyroTruthFit result;
  std::vector<double> residuals;
  double shift_s = BestShift(gyro, intervals);
  static_cast<void>(FitRotation(gyro, intervals, ToNanoseconds(shift_s), &residuals));
  result.left_out = LeaveOutliersOut(residuals, &intervals);
  shift_s = BestShift(gyro, intervals);
  const RotationFit fit = FitRotation(gyro, intervals, ToNanoseconds(shift_s), &residuals);
  // Two axes with 0.05 rad/s each.
  if (fit.mean_square > 1e200 || fit.second_singular < 0.05 * 0.05) return std::nullopt;
  result.time_shift_s = shift_s;
  result.R_IB = Eigen::Quaterniond(fit.R);
  result.bias = fit.bias;
  result.rms_rad_per_s = std::sqrt(fit.mean_square);
  for (const double r : residuals) result.intervals += r >= 0.0 ? 1 : 0;
  // Curvature of the summed squares against the shift.
  constexpr double kProbe_s = 0.002;
  const double up = FitRotation(gyro, intervals, ToNanoseconds(shift_s + kProbe_s)).mean_square;
  const double down = FitRotation(gyro, intervals, ToNanoseconds(shift_s - kProbe_s)).mean_square;
  const double curvature = (up + down - 2.0 * fit.mean_square) / (kProbe_s * kProbe_s);
  result.time_sigma_s =
      curvature > 0.0
          ? std::sqrt(2.0 * fit.mean_square / 3.0 / (curvature * std::max(1, result.intervals)))
          : kMaxShift_s;
  return result;
}

std::optional<GravityFit> FitGravityToTruth(const std::vector<ImuSample>& imu,
                                            const std::vector<StampedPose>& truth,
                                            double time_shift_s) {
  struct Row {
    Matrix3d R;       // weighted mean rotation
    Vector3d target;  // weighted mean R a_m, minus the second difference
  };
  const Timestamp arm = ToNanoseconds(kArm_s);
  const Timestamp shift = ToNanoseconds(time_shift_s);
  std::vector<Row> rows;
  std::vector<StampedPose> poses = truth;
  MakeQuaternionSignsContinuous(&poses);
  if (imu.size() < 2 || poses.size() < 3) return std::nullopt;
  std::size_t cursor = 0;
  for (Timestamp middle = poses.front().timestamp + arm; middle + arm <= poses.back().timestamp;
       middle += arm) {
    const auto before = InterpolatePose(poses, middle - arm, 0.06);
    const auto here = InterpolatePose(poses, middle, 0.06);
    const auto after = InterpolatePose(poses, middle + arm, 0.06);
    if (!before || !here || !after) continue;
    if (middle - arm + shift < imu.front().timestamp) continue;
    if (middle + arm + shift > imu.back().timestamp) break;
    Row row{Matrix3d::Zero(), Vector3d::Zero()};
    double weights = 0.0;
    bool known = true;
    while (cursor < imu.size() && imu[cursor].timestamp < middle - arm + shift) ++cursor;
    for (std::size_t i = cursor; i < imu.size(); ++i) {
      const Timestamp t = imu[i].timestamp - shift;
      if (t >= middle + arm) break;
      // The second difference is the mean of the acceleration under a triangle.
      const double weight = 1.0 - std::abs(SecondsBetween(middle, t)) / kArm_s;
      const auto pose = InterpolatePose(poses, t, 0.06);
      if (!pose) {
        known = false;
        break;
      }
      row.R += weight * pose->R.toRotationMatrix();
      row.target += weight * (pose->R * imu[i].a_m);
      weights += weight;
    }
    if (!known || weights < 5.0) continue;
    row.R /= weights;
    row.target /= weights;
    row.target -= (after->p - 2.0 * here->p + before->p) / (kArm_s * kArm_s);
    rows.push_back(row);
  }
  if (rows.size() < 4) return std::nullopt;

  constexpr double kBiasPrior = 0.2;  // m/s^2, 1 sigma
  Eigen::Matrix<double, 6, 1> x = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> H;
  double sigma = 1.0;
  for (int round = 0; round < 8; ++round) {
    H.setZero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    std::vector<double> norms;
    for (const Row& row : rows) {
      Eigen::Matrix<double, 3, 6> J;
      J << Matrix3d::Identity(), row.R;
      const double norm = (row.target - J * x).norm();
      // Jumps of the truth make second differences of metres a second squared: Cauchy weights.
      const double weight = round == 0 ? 1.0 : 1.0 / (1.0 + std::pow(norm / (2.0 * sigma), 2));
      H += weight * J.transpose() * J;
      b += weight * J.transpose() * row.target;
      norms.push_back(norm);
    }
    const double prior = round == 0 ? 1e-3 : std::pow(sigma / kBiasPrior, 2);
    H.bottomRightCorner<3, 3>().diagonal().array() += prior;
    x = H.ldlt().solve(b);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      norms[i] = (rows[i].target - x.head<3>() - rows[i].R * x.tail<3>()).norm();
    }
    std::nth_element(norms.begin(), norms.begin() + static_cast<std::ptrdiff_t>(norms.size() / 2),
                     norms.end());
    // The median of a norm of three normals is 1.54 of their sigma.
    sigma = std::max(1e-4, norms[norms.size() / 2] / 1.54);
  }
  GravityFit fit;
  fit.minus_g_G = x.head<3>();
  fit.b_a = x.tail<3>();
  fit.rms_m_per_s2 = sigma;
  fit.sigma = sigma * H.inverse().diagonal().head<3>().cwiseSqrt();
  fit.intervals = static_cast<int>(rows.size());
  return fit;
}

}  // namespace duet
