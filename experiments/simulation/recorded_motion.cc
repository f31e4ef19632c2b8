#include "experiments/simulation/recorded_motion.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

#include "common/geometry/so3.h"
#include "common/imu/imu_buffer.h"
#include "common/imu/imu_delta.h"
#include "common/imu/motion_between_poses.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

using Eigen::Vector3d;

constexpr double kDegrees = 180.0 / 3.14159265358979323846;
constexpr double kShortest_s = 5.0;

// What a reading has beyond the spline.
struct Departure {
  double t_s;  // since the spline's start
  Vector3d gyroscope;
  Vector3d accelerometer;
};

// The poses that the IMU covers, moved as the options say.
std::vector<StampedPose> AlignedPoses(const Recording& recording,
                                      const RecordedMotionOptions& options,
                                      RecordedMotionReport* report) {
  report->fit = FitGyroToTruth(recording.imu, recording.truth->poses);
  Timestamp shift = 0;
  Eigen::Quaterniond R_BI = Eigen::Quaterniond::Identity();
  if (report->fit && options.apply_time_shift) {
    report->applied_shift_s = report->fit->time_shift_s;
    shift = ToNanoseconds(report->fit->time_shift_s);
  }
  if (report->fit && options.apply_rotation) {
    R_BI = report->fit->R_IB.conjugate();
    report->applied_rotation_deg = Log(R_BI).norm() * kDegrees;
  }
  std::vector<StampedPose> poses;
  for (StampedPose pose : recording.truth->poses) {
    pose.timestamp += shift;
    pose.T_GB.R = (pose.T_GB.R * R_BI).normalized();
    if (pose.timestamp < recording.imu.front().timestamp) continue;
    if (pose.timestamp > recording.imu.back().timestamp) break;
    poses.push_back(pose);
  }
  return poses;
}

void BridgeJumps(const Recording& recording, const RecordedMotionOptions& options,
                 std::vector<StampedPose>* poses, RecordedMotionReport* report) {
  report->jumps = FindPoseJumps(
      *poses, MotionBetweenPoses(*poses, recording.imu, recording.imu_sensor.calibration),
      recording.g_G(), options.jumps);
  const Pose before = poses->back().T_GB;
  RemovePoseJumps(report->jumps, poses);
  report->final_offset_m = (poses->back().T_GB.p - before.p).norm();
  report->final_offset_deg = BoxMinus(poses->back().T_GB.R, before.R).norm() * kDegrees;
}

std::vector<Departure> DeparturesFrom(const SplineTrajectory& trajectory, Timestamp start,
                                      const Recording& recording) {
  const ImuCorrection correct(recording.imu_sensor.calibration, {});
  std::vector<Departure> departures;
  for (const ImuSample& sample : recording.imu) {
    if (sample.timestamp < start) continue;
    if (sample.timestamp > trajectory.spline().end()) break;
    const Kinematics k = trajectory.spline().At(sample.timestamp);
    const ImuRates read = correct(sample.omega_m, sample.a_m);
    departures.push_back({SecondsBetween(start, sample.timestamp), read.omega_B - k.omega_B,
                          read.a_B - k.T_GB.R.conjugate() * (k.a_G - recording.g_G())});
  }
  return departures;
}

// Values linear between knots, by least squares.
class SlowCurve {
 public:
  SlowCurve(const std::vector<Departure>& departures, Vector3d Departure::*member, double spacing_s)
      : spacing_s_(spacing_s) {
    const int knots = static_cast<int>(std::ceil(departures.back().t_s / spacing_s)) + 1;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(knots, knots);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(knots, 3);
    for (const Departure& departure : departures) {
      const auto [i, share] = PlaceOf(departure.t_s, knots);
      const double weights[2] = {1.0 - share, share};
      for (int j = 0; j < 2; ++j) {
        b.row(i + j) += weights[j] * (departure.*member).transpose();
        for (int l = 0; l < 2; ++l) H(i + j, i + l) += weights[j] * weights[l];
      }
    }
    // Decides only for a knot that no reading tells of (the last one, just short of it).
    const double weak = 1e-6 * H.diagonal().maxCoeff();
    for (int i = 0; i + 1 < knots; ++i) {
      H(i, i) += weak;
      H(i + 1, i + 1) += weak;
      H(i, i + 1) -= weak;
      H(i + 1, i) -= weak;
    }
    values_ = H.ldlt().solve(b);
  }

  [[nodiscard]] Vector3d At(double t_s) const {
    const auto [i, share] = PlaceOf(t_s, static_cast<int>(values_.rows()));
    return ((1.0 - share) * values_.row(i) + share * values_.row(i + 1)).transpose();
  }

 private:
  struct Place {
    int knot;
    double share;
  };
  [[nodiscard]] Place PlaceOf(double t_s, int knots) const {
    const int knot = std::clamp(static_cast<int>(t_s / spacing_s_), 0, knots - 2);
    return {knot, t_s / spacing_s_ - knot};
  }
  double spacing_s_;
  Eigen::MatrixXd values_;  // a row a knot
};

double RootMeanSquare(double sum_of_squared_norms, std::size_t count) {
  return count == 0 ? 0.0 : std::sqrt(sum_of_squared_norms / (3.0 * static_cast<double>(count)));
}

MotionAgreement Agreement(const std::vector<Departure>& departures) {
  constexpr double kSlow_s = 0.1;
  constexpr std::size_t kWorst = 5;
  struct Sum {
    double gyroscope = 0.0;
    double accelerometer = 0.0;
    std::size_t count = 0;
  };
  Sum fast;
  Sum slow;
  std::vector<Sum> seconds(static_cast<std::size_t>(departures.back().t_s) + 1);
  for (std::size_t begin = 0; begin < departures.size();) {
    const auto slot = static_cast<long>(departures[begin].t_s / kSlow_s);
    Departure mean{departures[begin].t_s, Vector3d::Zero(), Vector3d::Zero()};
    std::size_t end = begin;
    for (; end < departures.size() && static_cast<long>(departures[end].t_s / kSlow_s) == slot;
         ++end) {
      mean.gyroscope += departures[end].gyroscope;
      mean.accelerometer += departures[end].accelerometer;
      fast.gyroscope += departures[end].gyroscope.squaredNorm();
      fast.accelerometer += departures[end].accelerometer.squaredNorm();
      ++fast.count;
    }
    const double count = static_cast<double>(end - begin);
    for (Sum* sum : {&slow, &seconds[static_cast<std::size_t>(mean.t_s)]}) {
      sum->gyroscope += (mean.gyroscope / count).squaredNorm();
      sum->accelerometer += (mean.accelerometer / count).squaredNorm();
      ++sum->count;
    }
    begin = end;
  }
  MotionAgreement agreement;
  agreement.gyroscope_rms = RootMeanSquare(fast.gyroscope, fast.count);
  agreement.accelerometer_rms = RootMeanSquare(fast.accelerometer, fast.count);
  agreement.slow_gyroscope_rms = RootMeanSquare(slow.gyroscope, slow.count);
  agreement.slow_accelerometer_rms = RootMeanSquare(slow.accelerometer, slow.count);
  for (std::size_t i = 0; i < seconds.size(); ++i) {
    agreement.worst.push_back({static_cast<double>(i),
                               RootMeanSquare(seconds[i].gyroscope, seconds[i].count),
                               RootMeanSquare(seconds[i].accelerometer, seconds[i].count)});
  }
  const auto badness = [&](const MotionAgreement::Second& second) {
    return second.slow_gyroscope_rms / agreement.slow_gyroscope_rms +
           second.slow_accelerometer_rms / agreement.slow_accelerometer_rms;
  };
  std::stable_sort(agreement.worst.begin(), agreement.worst.end(),
                   [&](const auto& a, const auto& b) { return badness(a) > badness(b); });
  if (agreement.worst.size() > kWorst) agreement.worst.resize(kWorst);
  return agreement;
}

double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

PredictionErrors Predictions(const RecordedMotion& motion, const Vector3d& g_G) {
  constexpr Timestamp kSpan = 1'000'000'000;
  ImuBuffer buffer;
  for (const ImuSample& sample : motion.imu) buffer.Add(sample);
  std::vector<double> metres;
  std::vector<double> degrees;
  std::vector<ImuSample> readings;
  Timestamp next = motion.start;
  const PoseSpline& spline = motion.trajectory->spline();
  for (const InertialState& state : motion.states) {
    if (state.instant < next) continue;
    if (state.instant + kSpan > spline.end()) break;
    next = state.instant + kSpan;
    buffer.Extract(state.instant, next, &readings);
    const ImuDelta delta = IntegrateImu(
        readings, state.biases, motion.imu_sensor.calibration, motion.imu_sensor.noise,
        {.covariance = false, .bias_jacobians = false, .calibration_jacobians = false});
    const NavState predicted = Predict(state.nav, delta, g_G);
    const Pose T_GB = spline.At(next).T_GB;
    metres.push_back((predicted.p_GB - T_GB.p).norm());
    degrees.push_back(BoxMinus(predicted.R_GB, T_GB.R).norm() * kDegrees);
  }
  if (metres.empty()) return {};
  return {.count = static_cast<int>(metres.size()),
          .median_m = Quantile(metres, 0.5),
          .p95_m = Quantile(metres, 0.95),
          .largest_m = Quantile(metres, 1.0),
          .median_deg = Quantile(degrees, 0.5),
          .p95_deg = Quantile(degrees, 0.95),
          .largest_deg = Quantile(degrees, 1.0)};
}

// Against the recording's own biases, where it has them.
void CompareBiases(const Recording& recording, const std::vector<InertialState>& states,
                   RecordedMotionReport* report) {
  const GroundTruth& truth = *recording.truth;
  if (!truth.has_biases()) return;
  double b_g = 0.0;
  double b_a = 0.0;
  std::size_t i = 0;
  for (const InertialState& state : states) {
    while (i + 1 < truth.poses.size() && truth.poses[i].timestamp < state.instant) ++i;
    b_g += (state.biases.b_g - truth.biases[i].b_g).squaredNorm();
    b_a += (state.biases.b_a - truth.biases[i].b_a).squaredNorm();
  }
  report->b_g_difference = RootMeanSquare(b_g, states.size());
  report->b_a_difference = RootMeanSquare(b_a, states.size());
}

__attribute__((format(printf, 2, 3))) void Print(std::string* text, const char* format, ...) {
  char line[320];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(line, sizeof(line), format, arguments);
  va_end(arguments);
  *text += line;
}

}  // namespace

RecordedMotion FollowRecording(const Recording& recording, const std::string& name,
                               const RecordedMotionOptions& options) {
  if (!recording.truth) {
    throw InputError(recording.folder, 0, "", "no truth; a motion along it needs one");
  }
  RecordedMotion motion;
  RecordedMotionReport& report = motion.report;
  report.label = "real IMU, synthetic vision along " + name + "'s truth";
  if (recording.imu.size() < 2) throw InputError(recording.folder, 0, "", "no IMU samples");
  std::vector<StampedPose> poses = AlignedPoses(recording, options, &report);
  const double shared_s =
      poses.empty() ? 0.0 : SecondsBetween(poses.front().timestamp, poses.back().timestamp);
  if (poses.size() < 2 || shared_s < kShortest_s) {
    throw InputError(recording.truth_file, 0, "",
                     "truth and IMU share " + FormatFixed(shared_s, 1) + " s; expected at least " +
                         FormatFixed(kShortest_s, 0) +
                         " s, for a spline through the truth and slow biases of the IMU");
  }
  BridgeJumps(recording, options, &poses, &report);
  motion.trajectory = SplineThrough(std::move(poses), recording.truth_file,
                                    {.knot_spacing_s = options.knot_spacing_s});
  motion.start = motion.trajectory->spline().start();
  motion.imu = recording.imu;
  motion.imu_sensor = recording.imu_sensor;

  std::vector<Departure> departures = DeparturesFrom(*motion.trajectory, motion.start, recording);
  const SlowCurve b_g(departures, &Departure::gyroscope, options.bias_knots_s);
  const SlowCurve b_a(departures, &Departure::accelerometer, options.bias_knots_s);
  const ImuCalibration& T = recording.imu_sensor.calibration;
  for (const ImuSample& sample : recording.imu) {
    if (sample.timestamp < motion.start) continue;
    if (sample.timestamp > motion.trajectory->spline().end()) break;
    const Kinematics k = motion.trajectory->spline().At(sample.timestamp);
    const double t_s = SecondsBetween(motion.start, sample.timestamp);
    // The departures are of corrected rates; the biases belong to the readings.
    const Vector3d a = b_a.At(t_s);
    motion.states.push_back({.instant = sample.timestamp,
                             .nav = {.R_GB = k.T_GB.R, .p_GB = k.T_GB.p, .v_GB = k.v_GB},
                             .biases = {.b_g = T.T_g * b_g.At(t_s) + T.T_s * a, .b_a = T.T_a * a}});
  }
  for (Departure& departure : departures) {
    departure.gyroscope -= b_g.At(departure.t_s);
    departure.accelerometer -= b_a.At(departure.t_s);
  }
  report.agreement = Agreement(departures);
  report.prediction = Predictions(motion, recording.g_G());
  CompareBiases(recording, motion.states, &report);
  return motion;
}

RecordedMotion LoadRecordedMotion(const std::filesystem::path& folder,
                                  const RecordedMotionOptions& options) {
  const std::filesystem::path plain = std::filesystem::absolute(folder).lexically_normal();
  std::filesystem::path name = plain.filename().empty() ? plain.parent_path() : plain;
  if (name.filename() == "mav0") name = name.parent_path();
  RecordingOptions none;
  none.source = RecordingOptions::Source::kNone;
  return FollowRecording(LoadRecording(folder, none), name.filename().string(), options);
}

std::string RecordedMotionText(const RecordedMotionReport& report, Timestamp start,
                               bool all_jumps) {
  std::string text = report.label + "\n";
  if (report.fit) {
    Print(&text,
          "  IMU against truth: stamps %+.3f ms (1 sigma %.3f), turned by %.3f deg; applied %+.3f "
          "ms, %.3f deg\n",
          1e3 * report.fit->time_shift_s, 1e3 * report.fit->time_sigma_s,
          Log(report.fit->R_IB).norm() * kDegrees, 1e3 * report.applied_shift_s,
          report.applied_rotation_deg);
  } else {
    text += "  IMU against truth: the rig turns too little to tell shift and rotation\n";
  }
  const PoseJump* largest = nullptr;
  for (const PoseJump& jump : report.jumps) {
    if (largest == nullptr || jump.displacement.norm() > largest->displacement.norm()) {
      largest = &jump;
    }
  }
  Print(&text, "  jumps of the truth, bridged with the IMU: %zu", report.jumps.size());
  if (largest != nullptr) {
    Print(&text, ", the largest %.1f mm; %.1f mm and %.3f deg off the recorded truth at the end",
          1e3 * largest->displacement.norm(), 1e3 * report.final_offset_m, report.final_offset_deg);
  }
  text += "\n";
  for (const PoseJump& jump : report.jumps) {
    if (!all_jumps) break;
    Print(&text, "    at %8.3f s  %6.1f mm  %6.3f deg\n", SecondsBetween(start, jump.after),
          1e3 * jump.displacement.norm(), jump.rotation.norm() * kDegrees);
  }
  const MotionAgreement& a = report.agreement;
  Print(&text,
        "  IMU minus spline: %.4f rad/s, %.3f m/s^2 rms; means over 0.1 s %.5f rad/s, %.4f m/s^2\n",
        a.gyroscope_rms, a.accelerometer_rms, a.slow_gyroscope_rms, a.slow_accelerometer_rms);
  text += "  worst seconds:";
  for (const MotionAgreement::Second& second : a.worst) {
    Print(&text, " %.0f s (%.4f rad/s, %.3f m/s^2)", second.start_s, second.slow_gyroscope_rms,
          second.slow_accelerometer_rms);
  }
  const PredictionErrors& p = report.prediction;
  Print(&text,
        "\n  1 s of IMU against the spline (%d): %.1f mm median, %.1f p95, %.1f at most; %.3f deg "
        "median, %.3f p95, %.3f at most\n",
        p.count, 1e3 * p.median_m, 1e3 * p.p95_m, 1e3 * p.largest_m, p.median_deg, p.p95_deg,
        p.largest_deg);
  if (report.b_g_difference && report.b_a_difference) {
    Print(&text, "  biases found minus the recording's: %.5f rad/s, %.4f m/s^2 rms\n",
          *report.b_g_difference, *report.b_a_difference);
  }
  return text;
}

}  // namespace duet
