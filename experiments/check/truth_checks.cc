#include "experiments/check/truth_checks.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/angle.h"
#include "common/geometry/pose_jumps.h"
#include "common/imu/inertial_truth_fit.h"
#include "common/imu/motion_between_poses.h"
#include "experiments/check/stamp_checks.h"

namespace duet {
namespace {

void CheckJumps(const Recording& recording, Timestamp origin, Findings* findings) {
  const std::vector<StampedPose>& poses = recording.truth->poses;
  if (poses.size() < 4) return;
  const std::vector<PoseJump> jumps = FindPoseJumps(
      poses, MotionBetweenPoses(poses, recording.imu, recording.imu_sensor.calibration),
      recording.g_G());
  if (jumps.empty()) {
    findings->push_back({Severity::kInfo,
                         "truth.jumps",
                         "the truth has no jumps against the IMU",
                         "",
                         {{"count", 0.0}}});
    return;
  }
  const PoseJump* largest = &jumps.front();
  double largest_turn = 0.0;
  for (const PoseJump& jump : jumps) {
    if (jump.displacement.norm() > largest->displacement.norm()) largest = &jump;
    largest_turn = std::max(largest_turn, jump.rotation.norm());
  }
  std::vector<PoseJump> ordered = jumps;
  std::sort(ordered.begin(), ordered.end(), [](const PoseJump& a, const PoseJump& b) {
    return a.displacement.norm() > b.displacement.norm();
  });
  std::string list;
  for (std::size_t i = 0; i < std::min<std::size_t>(5, ordered.size()); ++i) {
    list += Sentence("%s%.1f mm and %.2f deg at %s", i == 0 ? "" : ", ",
                     1e3 * ordered[i].displacement.norm(),
                     kDegreesPerRadian * ordered[i].rotation.norm(),
                     SinceOrigin(ordered[i].after, origin).c_str());
  }
  findings->push_back(
      {Severity::kWarning,
       "truth.jumps",
       Sentence("the truth jumps %zu time%s against the IMU: %s%s", jumps.size(),
                jumps.size() == 1 ? "" : "s", list.c_str(), ordered.size() > 5 ? ", ..." : ""),
       "Do not interpolate across them and do not take velocities there; errors after a jump "
       "include it.",
       {{"count", static_cast<double>(jumps.size())},
        {"largest_m", largest->displacement.norm()},
        {"largest_rotation_rad", largest_turn}}});
}

void CheckColumns(const GroundTruth& truth, Timestamp origin, Findings* findings) {
  int flips = 0;
  Timestamp first_flip = 0;
  for (std::size_t i = 1; i < truth.poses.size(); ++i) {
    if (truth.poses[i - 1].T_GB.R.dot(truth.poses[i].T_GB.R) >= 0.0) continue;
    if (flips++ == 0) first_flip = truth.poses[i].timestamp;
  }
  if (flips > 0) {
    findings->push_back(
        {Severity::kInfo,
         "truth.quaternion_signs",
         Sentence("the truth's quaternions change sign %d time%s, first at %s", flips,
                  flips == 1 ? "" : "s", SinceOrigin(first_flip, origin).c_str()),
         "Nothing here minds; linear interpolation of the four numbers would.",
         {{"count", static_cast<double>(flips)}}});
  }
  if (!truth.has_velocities() || !truth.has_biases()) {
    findings->push_back(
        {Severity::kInfo, "truth.unknown",
         Sentence("the truth holds no %s%s%s", truth.has_velocities() ? "" : "velocities",
                  truth.has_velocities() || truth.has_biases() ? "" : " and no ",
                  truth.has_biases() ? "" : "biases"),
         "Starts from the truth fit them to poses and IMU."});
  }
}

void CheckVelocities(const GroundTruth& truth, Findings* findings) {
  if (!truth.has_velocities() || truth.poses.size() < 3) return;
  std::vector<double> differences;
  for (std::size_t i = 1; i + 1 < truth.poses.size(); ++i) {
    const double dt_s = SecondsBetween(truth.poses[i - 1].timestamp, truth.poses[i + 1].timestamp);
    if (dt_s > 0.15) continue;
    const Eigen::Vector3d v = (truth.poses[i + 1].T_GB.p - truth.poses[i - 1].T_GB.p) / dt_s;
    differences.push_back((v - truth.velocities[i]).norm());
  }
  if (differences.empty()) return;
  std::sort(differences.begin(), differences.end());
  const double median = differences[differences.size() / 2];
  if (median < 0.05) return;
  findings->push_back({Severity::kWarning,
                       "truth.velocity",
                       Sentence("the truth's velocities differ from its positions' by %.3f m/s "
                                "(median)",
                                median),
                       "Are they in the body frame instead of G? Starts from the truth use poses "
                       "only; errors of velocities mean nothing.",
                       {{"median_m_per_s", median}}});
}

// The shift between gyro and truth that was found, for the gravity fit.
double CheckGyro(const Recording& recording, Findings* findings) {
  const auto fit = FitGyroToTruth(recording.imu, recording.truth->poses);
  if (!fit) {
    findings->push_back({Severity::kInfo, "gyro_truth.unknown",
                         "gyroscope and truth can't be compared: the rig hardly turns", ""});
    return 0.0;
  }
  const double angle_deg = Log(fit->R_IB).norm() * kDegreesPerRadian;
  const std::vector<Measurement> measured = {{"time_shift_s", fit->time_shift_s},
                                             {"time_sigma_s", fit->time_sigma_s},
                                             {"rotation_deg", angle_deg},
                                             {"b_g_x", fit->bias.x()},
                                             {"b_g_y", fit->bias.y()},
                                             {"b_g_z", fit->bias.z()},
                                             {"rms_rad_per_s", fit->rms_rad_per_s},
                                             {"left_out", static_cast<double>(fit->left_out)}};
  findings->push_back(
      {Severity::kInfo, "gyro_truth",
       Sentence("gyroscope against truth over %d intervals: the IMU's stamps are %.2f ms (1 sigma "
                "%.2f) later, turned by %.2f deg, bias %.4f %.4f %.4f rad/s, residual %.4f rad/s",
                fit->intervals, 1e3 * fit->time_shift_s, 1e3 * fit->time_sigma_s, angle_deg,
                fit->bias.x(), fit->bias.y(), fit->bias.z(), fit->rms_rad_per_s),
       "", measured});
  if (std::abs(fit->time_shift_s) > 3e-3 && std::abs(fit->time_shift_s) > 5.0 * fit->time_sigma_s) {
    findings->push_back(
        {Severity::kWarning, "gyro_truth.time_shift",
         Sentence("IMU and truth are %.1f ms apart", 1e3 * fit->time_shift_s),
         Sentence("%s %.1f ms to the truth's stamps; position errors of speed times shift are not "
                  "the estimator's.",
                  fit->time_shift_s > 0.0 ? "Add" : "Add (negative)", 1e3 * fit->time_shift_s),
         measured});
  }
  if (angle_deg > 1.0) {
    const Eigen::Vector3d v = Log(fit->R_IB) * kDegreesPerRadian;
    findings->push_back(
        {Severity::kWarning, "gyro_truth.rotation",
         Sentence("the truth's body frame is turned against the gyroscope's by %.2f deg (rotation "
                  "vector %.2f %.2f %.2f deg)",
                  angle_deg, v.x(), v.y(), v.z()),
         "The truth is of another body frame (T_BS of the truth's sensor), or its calibration is "
         "off: orientation errors of that size are not the estimator's.",
         measured});
  }
  return fit->time_shift_s;
}

void CheckGravity(const Recording& recording, double time_shift_s, Findings* findings) {
  const auto fit = FitGravityToTruth(recording.imu, recording.truth->poses, time_shift_s);
  if (!fit) return;
  const double size = fit->minus_g_G.norm();
  const Eigen::Vector3d up = fit->minus_g_G.normalized();
  const double tilt_deg = std::atan2(up.head<2>().norm(), up.z()) * kDegreesPerRadian;
  const double sigma = fit->sigma.maxCoeff();
  const double sigma_deg = sigma / size * kDegreesPerRadian;
  const std::vector<Measurement> measured = {{"gravity_m_per_s2", size},
                                             {"tilt_deg", tilt_deg},
                                             {"sigma_m_per_s2", sigma},
                                             {"b_a_x", fit->b_a.x()},
                                             {"b_a_y", fit->b_a.y()},
                                             {"b_a_z", fit->b_a.z()},
                                             {"rms_m_per_s2", fit->rms_m_per_s2}};
  findings->push_back(
      {Severity::kInfo, "gravity_truth",
       Sentence("gravity by accelerometer and truth: %.3f m/s^2 (1 sigma %.3f), %.2f deg off the "
                "truth's z axis; bias %.3f %.3f %.3f m/s^2",
                size, sigma, tilt_deg, fit->b_a.x(), fit->b_a.y(), fit->b_a.z()),
       "", measured});
  const double told = recording.imu_sensor.gravity;
  if (std::abs(size - told) > 0.05 + 4.0 * sigma) {
    findings->push_back(
        {std::abs(size - told) > 2.0 ? Severity::kError : Severity::kWarning, "gravity_truth.size",
         Sentence("gravity comes out as %.3f m/s^2, told is %.3f", size, told),
         "Units (g?), a wrong scale of accelerometer or positions, or gravity_m_per_s2 in "
         "imu0/sensor.yaml.",
         measured});
  }
  if (tilt_deg > 1.0 + 4.0 * sigma_deg) {
    findings->push_back(
        {tilt_deg > 20.0 ? Severity::kError : Severity::kWarning, "gravity_truth.direction",
         Sentence("gravity is %.2f deg off the truth's z axis", tilt_deg),
         tilt_deg > 20.0 ? "The truth's frame does not have z up, or its quaternions are inverted "
                           "(R_BG) or in another order (files hold w x y z)."
                         : "The truth's frame is tilted: align with se3, or level the truth.",
         measured});
  }
}

}  // namespace

Findings CheckTruth(const Recording& recording, Timestamp origin) {
  const GroundTruth& truth = *recording.truth;
  std::vector<Timestamp> stamps;
  for (const StampedPose& pose : truth.poses) stamps.push_back(pose.timestamp);
  Findings findings = CheckStamps("truth", stamps, 0.0, 0.0, origin);
  if (stamps.size() < 4 || recording.imu.size() < 4) return findings;
  if (stamps.back() < recording.imu.front().timestamp ||
      stamps.front() > recording.imu.back().timestamp) {
    findings.push_back({Severity::kError, "truth.overlap", "truth and IMU have no time in common",
                        "Their stamps are of different clocks, or the files of different "
                        "recordings."});
    return findings;
  }
  CheckColumns(truth, origin, &findings);
  CheckVelocities(truth, &findings);
  CheckJumps(recording, origin, &findings);
  const double time_shift_s = CheckGyro(recording, &findings);
  CheckGravity(recording, time_shift_s, &findings);
  return findings;
}

}  // namespace duet
