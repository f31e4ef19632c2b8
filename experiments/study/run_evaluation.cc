#include "experiments/study/run_evaluation.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/dataset/csv_reader.h"
#include "common/geometry/angle.h"
#include "common/geometry/so3.h"
#include "common/measurement/gauge.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "evaluation/consistency.h"
#include "evaluation/evaluate.h"
#include "experiments/calibration_watch.h"
#include "experiments/configuration.h"
#include "experiments/manifest_reader.h"
#include "experiments/record_reader.h"
#include "experiments/record_tables.h"
#include "experiments/timing_log.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

/// NEES as the metrics name it.
const char* NeesKey(NeesBlock block) {
  switch (block) {
    case NeesBlock::kPose:
      return "nees.pose";
    case NeesBlock::kOrientation:
      return "nees.orientation";
    case NeesBlock::kPosition:
      return "nees.position";
    case NeesBlock::kVelocity:
      return "nees.velocity";
    case NeesBlock::kGyroBias:
      return "nees.b_g";
    case NeesBlock::kAccelBias:
      return "nees.b_a";
    case NeesBlock::kState:
      break;
  }
  return nullptr;
}

/// One record's evaluation, part by part.
class RecordEvaluator {
 public:
  RecordEvaluator(const fs::path& record, const Recording& recording, bool simulated)
      : record_(record), recording_(recording), simulated_(simulated) {
    sources_.AddFile(record / "config.yaml");
    configuration_.Read(&sources_);
    const CalibrationPriors& priors = configuration_.shared.calibration;
    told_rig_ = ToldRig(recording.rig, priors);
    gauge_ = GaugeRotation(recording.rig, told_rig_, priors);
    layout_ = CalibrationLayout(priors, told_rig_);
  }

  RunEvaluation Evaluate() {
    const fs::path file = record_ / "manifest.json";
    const ManifestReader manifest(ReadTextFile(file), file.string());
    result_.failed = manifest.Text("outcome.status") != "done";
    result_.reason = manifest.Text("outcome.reason");
    first_frame_ = manifest.Integer("dataset.first_frame_ns", 0, kLatestStamp);
    last_frame_ = manifest.Integer("dataset.last_frame_ns", 0, kLatestStamp);
    const fs::path states_file = record_ / "states.csv";
    states_ = ReadStateTable(ReadTextFile(states_file), states_file.string());
    if (!recording_.truth) {
      LeaveOut("ate", "the recording has no truth");
    } else {
      TurnTruth();
      AddAccuracy();
      if (simulated_) {
        AddUnaligned();
        AddConsistency();
      }
    }
    if (simulated_ && layout_.size() > 0) AddCalibration();
    return std::move(result_);
  }

 private:
  void Add(const std::string& key, double value) {
    if (std::isfinite(value)) {
      result_.metrics.emplace_back(key, value);
    } else {
      LeaveOut(key, "is not finite");
    }
  }
  void LeaveOut(const std::string& key, const std::string& why) {
    result_.left_out.emplace_back(key, why);
  }

  /// Into the axes that the estimator's gauge ties the body to.
  void TurnTruth() {
    truth_ = *recording_.truth;
    for (StampedPose& pose : truth_.poses) {
      pose.T_GB.R = (pose.T_GB.R * gauge_.conjugate()).normalized();
    }
    for (const InertialState& state : states_) {
      const std::optional<InertialState> at = TruthStateAt(truth_, state.instant);
      if (!at) continue;
      result_.truth.poses.push_back({state.instant, at->nav.pose()});
      if (truth_.has_velocities()) result_.truth.velocities.push_back(at->nav.v_GB);
      if (truth_.has_biases()) result_.truth.biases.push_back(at->biases);
      pairs_.emplace_back(state, *at);
    }
  }

  void AddAccuracy() {
    EvaluationOptions options = configuration_.evaluation.Options();
    options.start = std::max(first_frame_, truth_.poses.front().timestamp);
    options.end = std::min(last_frame_, truth_.poses.back().timestamp);
    std::vector<StampedPose> estimate;
    for (const InertialState& state : states_) {
      estimate.push_back({state.instant, state.nav.pose()});
    }
    const Evaluation evaluation =
        duet::Evaluate({"truth", truth_.poses}, {{"estimate", estimate}}, options);
    const TrajectoryEvaluation& all = evaluation.estimates.front();
    const AbsoluteErrors& absolute = all.absolute;
    if (!absolute.alignment.alignment) {
      LeaveOut("ate", AlignmentRefusalText(absolute.alignment.refusal));
    } else {
      Add("ate.position_m", absolute.position_m.rmse);
      Add("ate.orientation_deg", absolute.orientation_deg.rmse);
      Add("ate.tilt_deg", absolute.tilt_deg.rmse);
      AddOtherAlignments(all.association.pairs);
    }
    for (const RelativeErrors& relative : all.relative) {
      const std::string length = FormatNumber(relative.length_m);
      if (relative.segments == 0) {
        LeaveOut("relative.position_m." + length, "no segment of this length");
        continue;
      }
      Add("relative.position_m." + length, relative.translation_m.median);
      Add("relative.orientation_deg." + length, relative.rotation_deg.median);
    }
    Add("coverage_share", all.coverage_share);
    // Of a truth that stands still; on any other path it is the path.
    const bool at_rest = !absolute.alignment.alignment &&
                         absolute.alignment.refusal == AlignmentRefusal::kCoincidentTruth;
    if (at_rest && all.drift) Add("drift_m", all.drift->position_max_m);
    AddMotion(evaluation);
  }

  void AddOtherAlignments(const std::vector<PosePair>& pairs) {
    for (const AlignmentMode mode : {AlignmentMode::kPositionYaw, AlignmentMode::kSe3,
                                     AlignmentMode::kFirstPose, AlignmentMode::kNone}) {
      if (mode == configuration_.evaluation.alignment) continue;
      const AbsoluteErrors errors =
          ComputeAbsoluteErrors(pairs, mode, configuration_.evaluation.Options().alignment_options);
      if (!errors.alignment.alignment) continue;
      const std::string name = AlignmentModeName(mode);
      Add("ate.position_m." + name, errors.position_m.rmse);
      Add("ate.orientation_deg." + name, errors.orientation_deg.rmse);
    }
  }

  void AddMotion(const Evaluation& evaluation) {
    double turned_rad = 0.0;
    const StampedPose* before = nullptr;
    for (const StampedPose& pose : truth_.poses) {
      if (pose.timestamp < evaluation.start || pose.timestamp > evaluation.end) continue;
      if (before != nullptr) turned_rad += pose.T_GB.R.angularDistance(before->T_GB.R);
      before = &pose;
    }
    Add("truth.way_m", evaluation.truth_way_m);
    Add("truth.duration_s", evaluation.span_s());
    if (!(evaluation.span_s() > 0.0)) return;
    Add("truth.speed_m_per_s", evaluation.truth_way_m / evaluation.span_s());
    Add("truth.rate_rad_per_s", turned_rad / evaluation.span_s());
  }

  void AddUnaligned() {
    if (pairs_.empty()) return;
    double position = 0.0;
    double orientation = 0.0;
    for (const auto& [state, truth] : pairs_) {
      const Vector15d error = BoxMinus(truth, state);
      orientation += error.head<3>().squaredNorm();
      position += error.segment<3>(3).squaredNorm();
    }
    const double count = static_cast<double>(pairs_.size());
    Add("rms.position_m", std::sqrt(position / count));
    Add("rms.orientation_deg", std::sqrt(orientation / count) * kDegreesPerRadian);
  }

  void AddConsistency() {
    const fs::path file = record_ / "covariance.csv";
    if (!fs::exists(file)) {
      LeaveOut("nees", "the record has no covariance.csv");
      return;
    }
    covariance_csv_ = ReadTextFile(file);
    const NeesRun run =
        ComputeNeesOfTables(states_, ReadCovarianceTable(covariance_csv_, file.string()), truth_);
    for (const NeesOfRun& nees : SummarizeNees(run, configuration_.evaluation.nees_settle_s)) {
      if (const char* key = NeesKey(nees.block)) Add(key, nees.mean);
    }
  }

  /// The estimate of the last state against the truth.
  void AddCalibration() {
    const RigCalibration true_rig = Reoriented(recording_.rig, gauge_);
    const std::vector<std::string> names = layout_.ComponentNames();
    const Eigen::VectorXd truth = ComponentValues(true_rig, layout_);
    for (std::size_t i = 0; i < names.size(); ++i) {
      result_.calibration_truth.emplace_back(names[i], truth[static_cast<Eigen::Index>(i)]);
    }
    const fs::path file = record_ / "calibration.csv";
    if (!fs::exists(file)) {
      LeaveOut("calibration", "there was no state");
      return;
    }
    const std::vector<CalibrationWatch::Number> numbers =
        ReadCalibrationCsv(ReadTextFile(file), file.string());
    if (numbers.size() != names.size()) {
      throw InputError(file.string(), 0, "", "does not hold the numbers that config.yaml asks for");
    }
    Eigen::VectorXd estimate(layout_.size());
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      estimate[static_cast<Eigen::Index>(i)] = numbers[i].value;
    }
    const Eigen::VectorXd error = CalibrationError(true_rig, truth, estimate);
    AddCalibrationNees(error);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      Add("calibration." + names[i] + ".error", error[static_cast<Eigen::Index>(i)]);
      Add("calibration." + names[i] + ".sigma", numbers[i].sigma);
    }
  }

  /// True minus estimate; of rotations, which files hold as rotation vectors, as DESIGN.md 3 says.
  [[nodiscard]] Eigen::VectorXd CalibrationError(const RigCalibration& true_rig,
                                                 const Eigen::VectorXd& truth,
                                                 const Eigen::VectorXd& estimate) const {
    Eigen::VectorXd error = truth - estimate;
    for (const CalibrationLayout::Entry& entry : layout_.entries()) {
      if (entry.block != CalibrationBlock::kExtrinsicRotation) continue;
      const Eigen::Quaterniond R_CB = true_rig.cameras[static_cast<std::size_t>(entry.camera)].R_CB;
      const Eigen::Vector3d estimated = estimate.segment<3>(entry.offset);
      error.segment<3>(entry.offset) = BoxMinus(R_CB, ExpQuaternion(estimated));
    }
    return error;
  }

  void AddCalibrationNees(const Eigen::VectorXd& error) {
    if (covariance_csv_.empty()) return;
    const std::string file = (record_ / "covariance.csv").string();
    const Eigen::MatrixXd covariance = ReadLastCovariance(covariance_csv_, file);
    const Eigen::Index size = error.size();
    if (covariance.rows() != 15 + size) {
      LeaveOut("nees.calibration", "its covariance is of another size");
      return;
    }
    const std::optional<double> nees = Nees(error, covariance.bottomRightCorner(size, size));
    if (nees) {
      Add("nees.calibration", *nees);
      Add("nees.calibration.dof", static_cast<double>(size));
    } else {
      LeaveOut("nees.calibration", "the covariance is not positive definite");
    }
  }

  const fs::path record_;
  const Recording& recording_;
  const bool simulated_;
  ConfigSources sources_;
  Configuration configuration_;
  RigCalibration told_rig_;
  Eigen::Quaterniond gauge_;
  CalibrationLayout layout_;
  Timestamp first_frame_ = 0;
  Timestamp last_frame_ = 0;
  std::vector<InertialState> states_;
  GroundTruth truth_;
  std::vector<std::pair<InertialState, InertialState>> pairs_;  // states and truths
  std::string covariance_csv_;
  RunEvaluation result_;
};

std::string EvaluationJson(const RunEvaluation& evaluation) {
  nlohmann::ordered_json json;
  json["failed"] = evaluation.failed;
  json["reason"] = evaluation.reason;
  json["metrics"] = nlohmann::ordered_json::object();
  for (const auto& [key, value] : evaluation.metrics) json["metrics"][key] = value;
  json["left_out"] = nlohmann::ordered_json::object();
  for (const auto& [key, why] : evaluation.left_out) json["left_out"][key] = why;
  return json.dump(2) + "\n";
}

std::string CalibrationTruthCsv(const NamedNumbers& truth) {
  std::string text = "name,true\n";
  for (const auto& [name, value] : truth) text += name + "," + FormatNumber(value) + "\n";
  return text;
}

}  // namespace

RunEvaluation EvaluateRecord(const fs::path& record, const Recording& recording, bool simulated) {
  return RecordEvaluator(record, recording, simulated).Evaluate();
}

NamedNumbers CostOfRecord(const fs::path& record) {
  NamedNumbers cost;
  const fs::path timing = record / "timing.csv";
  for (const auto& [column, values] : ReadTimingTable(ReadTextFile(timing), timing.string())) {
    if (column != "estimator" || values.empty()) continue;
    const ErrorSummary summary = Summarize(values);
    cost.emplace_back("frame_ms.median", summary.median);
    cost.emplace_back("frame_ms.p99", summary.p99);
  }
  const fs::path file = record / "manifest.json";
  const double memory_mb =
      ManifestReader(ReadTextFile(file), file.string()).Number("peak_memory_mb");
  if (memory_mb >= 0.0) cost.emplace_back("peak_memory_mb", memory_mb);
  return cost;
}

std::vector<std::pair<std::string, std::string>> EvaluationTexts(const RunEvaluation& evaluation) {
  std::vector<std::pair<std::string, std::string>> texts = {
      {"evaluation.json", EvaluationJson(evaluation)}};
  if (!evaluation.truth.poses.empty()) {
    texts.emplace_back("truth.csv", WriteGroundTruthTable(evaluation.truth));
  }
  if (!evaluation.calibration_truth.empty()) {
    texts.emplace_back("calibration_truth.csv", CalibrationTruthCsv(evaluation.calibration_truth));
  }
  return texts;
}

void WriteRunEvaluation(const RunEvaluation& evaluation, const fs::path& record) {
  for (const auto& [name, text] : EvaluationTexts(evaluation)) WriteTextFile(record / name, text);
}

RunEvaluation ReadEvaluation(const fs::path& record) {
  const fs::path file = record / "evaluation.json";
  return ParseEvaluation(ReadTextFile(file), file.string());
}

RunEvaluation ParseEvaluation(std::string_view text, const std::string& file) {
  RunEvaluation evaluation;
  try {
    const auto json = nlohmann::ordered_json::parse(text);
    evaluation.failed = json.at("failed").get<bool>();
    evaluation.reason = json.at("reason").get<std::string>();
    for (const auto& [key, value] : json.at("metrics").items()) {
      evaluation.metrics.emplace_back(key, value.get<double>());
    }
    for (const auto& [key, value] : json.at("left_out").items()) {
      evaluation.left_out.emplace_back(key, value.get<std::string>());
    }
  } catch (const nlohmann::ordered_json::exception& error) {
    throw InputError(file, 0, "", std::string("is no evaluation: ") + error.what());
  }
  return evaluation;
}

}  // namespace duet
