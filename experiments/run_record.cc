#include "experiments/run_record.h"

#include <cmath>

#include "common/support/numeric_text.h"

namespace duet {
namespace {

constexpr const char* kStateColumns =
    "#timestamp [ns],frame [ns],status,q_GB_x [],q_GB_y [],q_GB_z [],q_GB_w [],"
    "p_GB_x [m],p_GB_y [m],p_GB_z [m],v_GB_x [m s^-1],v_GB_y [m s^-1],v_GB_z [m s^-1],"
    "b_g_x [rad s^-1],b_g_y [rad s^-1],b_g_z [rad s^-1],"
    "b_a_x [m s^-2],b_a_y [m s^-2],b_a_z [m s^-2]";
constexpr const char* kSigmaColumns =
    ",sigma_theta_x [rad],sigma_theta_y [rad],sigma_theta_z [rad],"
    "sigma_p_x [m],sigma_p_y [m],sigma_p_z [m],"
    "sigma_v_x [m s^-1],sigma_v_y [m s^-1],sigma_v_z [m s^-1],"
    "sigma_b_g_x [rad s^-1],sigma_b_g_y [rad s^-1],sigma_b_g_z [rad s^-1],"
    "sigma_b_a_x [m s^-2],sigma_b_a_y [m s^-2],sigma_b_a_z [m s^-2]";
constexpr int kStateSize = 15;

template <class Vector>
void AppendRow(const Vector& values, std::string* row) {
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    *row += ',';
    AppendNumber(values[i], row);
  }
}

int ObservationCount(const TrackFrameSet& frames) {
  std::size_t count = 0;
  for (const TrackFrame& frame : frames.frames) count += frame.observations.size();
  return static_cast<int>(count);
}

}  // namespace

RunRecorder::RunRecorder(const std::filesystem::path& folder, const CalibrationLayout& layout,
                         const RigCalibration& told, const TimeBounds& bounds, bool with_covariance)
    : folder_(folder),
      layout_(layout),
      calibration_(layout, told, bounds),
      trajectory_(folder / "trajectory.tum"),
      states_(folder / "states.csv"),
      features_(folder / "features.csv") {
  trajectory_.Write("# timestamp [s] tx ty tz [m] qx qy qz qw: the body (IMU) in G\n");
  std::string header = kStateColumns;
  std::vector<std::string> names = layout_.ComponentNames();
  const std::vector<std::string> units = layout_.ComponentUnits();
  for (std::size_t i = 0; i < names.size(); ++i) names[i] += " [" + units[i] + "]";
  for (const std::string& name : names) header += "," + name;
  header += kSigmaColumns;
  for (const std::string& name : names) header += ",sigma_" + name;
  states_.Write(header + "\n");
  features_.Write(
      "#timestamp [ns],status,observed,used,cleaned,gated,not triangulated,too short,lost,keyframe,"
      "standstill,iterations\n");
  if (with_covariance) {
    covariance_.emplace(folder / "covariance.csv");
    covariance_->Write(
        "#timestamp [ns],size,lower triangle by rows, order theta p v b_g b_a calibration\n");
  }
}

void RunRecorder::CountFrame(const TrackFrameSet& frames) {
  if (summary_.frames++ == 0) first_frame_ = frames.timestamp;
  if (!summary_.first_instant) {
    summary_.waited_s = SecondsBetween(first_frame_, frames.timestamp);
  }
}

void RunRecorder::AddWaiting(const TrackFrameSet& frames) {
  CountFrame(frames);
  ++summary_.waiting;
  FeatureCounts counts;
  counts.observed = ObservationCount(frames);
  AddFeatures(frames, EstimatorStatusName(EstimatorStatus::kInitializing), counts);
  features_.Write(row_ + ",0,0,0\n");
}

void RunRecorder::Add(const TrackFrameSet& frames, const EstimatorOutput& output) {
  CountFrame(frames);
  AddFeatures(frames, EstimatorStatusName(output.status), output.features);
  row_ += output.keyframe ? ",1" : ",0";
  row_ += output.standstill ? ",1," : ",0,";
  AppendNumber(output.iterations, &row_);
  features_.Write(row_ + "\n");
  summary_.last_status = output.status;
  switch (output.status) {
    case EstimatorStatus::kInitializing:
      ++summary_.waiting;
      return;
    case EstimatorStatus::kFailed:
      summary_.failure = output.reason.empty() ? "no reason given" : output.reason;
      summary_.failure_instant = output.state.instant;
      return;
    case EstimatorStatus::kTracking:
      ++summary_.tracking;
      break;
    case EstimatorStatus::kDeadReckoning:
      ++summary_.dead_reckoning;
      break;
  }
  // Frames that are skipped before the estimator took its first have no state yet.
  if (!summary_.first_instant && output.status == EstimatorStatus::kDeadReckoning &&
      output.covariance.size() == 0) {
    ++summary_.skipped;
    return;
  }
  // A frame that the IMU does not cover leaves the state where it was.
  if (summary_.last_instant && output.state.instant <= *summary_.last_instant) {
    ++summary_.skipped;
    return;
  }
  if (!summary_.first_instant) summary_.first_instant = output.state.instant;
  summary_.last_instant = output.state.instant;
  AddState(output);
  calibration_.Add(output);
  if (covariance_) AddCovariance(output);
}

void RunRecorder::AddState(const EstimatorOutput& output) {
  const Pose T_GB = output.state.nav.pose();
  const Eigen::Vector4d q = T_GB.R.coeffs();  // x y z w
  row_.clear();
  AppendSeconds(output.state.instant, &row_);
  for (const double value : {T_GB.p.x(), T_GB.p.y(), T_GB.p.z(), q[0], q[1], q[2], q[3]}) {
    row_ += ' ';
    AppendNumber(value, &row_);
  }
  trajectory_.Write(row_ + "\n");

  row_.clear();
  AppendNumber(output.state.instant, &row_);
  row_ += ',';
  AppendNumber(output.frame_timestamp, &row_);
  row_ += ',';
  row_ += EstimatorStatusName(output.status);
  AppendRow(q, &row_);
  AppendRow(T_GB.p, &row_);
  AppendRow(output.state.nav.v_GB, &row_);
  AppendRow(output.state.biases.b_g, &row_);
  AppendRow(output.state.biases.b_a, &row_);
  AppendRow(ComponentValues(output.rig, layout_), &row_);
  // An estimator that was told to give no covariance leaves the fields empty.
  const Eigen::Index size = kStateSize + layout_.size();
  if (output.covariance.rows() == size) {
    AppendRow(output.covariance.diagonal().cwiseMax(0.0).cwiseSqrt(), &row_);
  } else {
    row_.append(static_cast<std::size_t>(size), ',');
  }
  states_.Write(row_ + "\n");
}

void RunRecorder::AddCovariance(const EstimatorOutput& output) {
  row_.clear();
  AppendNumber(output.state.instant, &row_);
  row_ += ',';
  AppendNumber(static_cast<std::int64_t>(output.covariance.rows()), &row_);
  for (Eigen::Index i = 0; i < output.covariance.rows(); ++i) {
    AppendRow(output.covariance.row(i).head(i + 1), &row_);
  }
  covariance_->Write(row_ + "\n");
}

void RunRecorder::AddFeatures(const TrackFrameSet& frames, const char* status,
                              const FeatureCounts& counts) {
  row_.clear();
  AppendNumber(frames.timestamp, &row_);
  row_ += ',';
  row_ += status;
  for (const int count : {counts.observed, counts.used, counts.cleaned, counts.gated,
                          counts.not_triangulated, counts.too_short, counts.lost}) {
    row_ += ',';
    AppendNumber(count, &row_);
  }
}

void RunRecorder::Close() {
  const std::vector<CalibrationWatch::Number> numbers = calibration_.Numbers();
  if (!numbers.empty()) WriteTextFile(folder_ / "calibration.csv", CalibrationCsv(numbers));
  trajectory_.Close();
  states_.Close();
  features_.Close();
  if (covariance_) covariance_->Close();
}

}  // namespace duet
