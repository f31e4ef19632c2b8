#include "experiments/report/run_curves.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "common/geometry/interpolation.h"
#include "common/geometry/so3.h"
#include "common/support/text_file.h"
#include "evaluation/association.h"
#include "evaluation/errors.h"
#include "experiments/record_reader.h"
#include "experiments/record_tables.h"
#include "experiments/report/page_text.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// Where a group of columns begins in RunCurves::columns (kCurveColumns without t).
enum CurveColumn : std::size_t {
  kPosition = 0,
  kRotation = 3,
  kPositionError = 6,
  kRotationError = 9,
  kCovariance = 12,
  kRotationSigma = 18,
  kNees = 21,
};

// Thinned by: not the rotation, nor the covariance off its diagonal.
constexpr std::array<std::size_t, 18> kThinnedBy = {0,  1,  2,  6,  7,  8,  9,  10, 11,
                                                    12, 15, 17, 18, 19, 20, 21, 22, 23};

void SetVector(const Eigen::Vector3d& values, std::size_t row, std::size_t first,
               RunCurves* curves) {
  for (int k = 0; k < 3; ++k) curves->columns[first + static_cast<std::size_t>(k)][row] = values[k];
}

void SetErrors(const std::vector<InertialState>& states, const GroundTruth& truth,
               RunCurves* curves) {
  std::vector<PosePair> pairs;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const std::optional<Pose> pose =
        InterpolatePose(truth.poses, states[i].instant, AssociationOptions{}.max_truth_gap_s);
    if (!pose) continue;
    SetVector(pose->p - states[i].nav.p_GB, i, kPositionError, curves);
    SetVector(BoxMinus(pose->R, states[i].nav.R_GB), i, kRotationError, curves);
    pairs.push_back({states[i].instant, *pose, states[i].nav.pose()});
  }
  const AbsoluteErrors errors = ComputeAbsoluteErrors(pairs, AlignmentMode::kPositionYaw);
  if (errors.alignment.alignment && errors.orientation_R_GE) {
    curves->alignment = {errors.alignment.alignment->R_GE, errors.alignment.alignment->p_GE,
                         *errors.orientation_R_GE};
  }
}

void SetCovariances(const std::vector<RecordedCovariance>& covariances, RunCurves* curves) {
  auto covariance = covariances.begin();
  for (std::size_t i = 0; i < curves->instants.size(); ++i) {
    while (covariance != covariances.end() && covariance->instant < curves->instants[i]) {
      ++covariance;
    }
    if (covariance == covariances.end()) return;
    if (covariance->instant != curves->instants[i]) continue;
    const Matrix15d& P = covariance->covariance;  // theta, p, ...
    const std::array<double, 6> upper = {P(3, 3), P(3, 4), P(3, 5), P(4, 4), P(4, 5), P(5, 5)};
    for (std::size_t k = 0; k < upper.size(); ++k) curves->columns[kCovariance + k][i] = upper[k];
    SetVector(P.diagonal().head<3>().cwiseSqrt(), i, kRotationSigma, curves);
  }
}

void SetNees(const NeesRun& nees, RunCurves* curves) {
  constexpr std::array<NeesBlock, 3> kBlocks = {NeesBlock::kPose, NeesBlock::kPosition,
                                                NeesBlock::kOrientation};
  for (const NeesSample& sample : nees.samples) {
    const auto found =
        std::lower_bound(curves->instants.begin(), curves->instants.end(), sample.timestamp);
    if (found == curves->instants.end() || *found != sample.timestamp) continue;
    const auto row = static_cast<std::size_t>(found - curves->instants.begin());
    for (std::size_t k = 0; k < kBlocks.size(); ++k) {
      curves->columns[kNees + k][row] =
          sample.value[static_cast<std::size_t>(kBlocks[k])].value_or(kUnknown);
    }
  }
}

// Rows of the extremes of each stretch, ascending, each once.
std::vector<std::size_t> ExtremeRows(const RunCurves& curves, std::size_t stretches) {
  const std::size_t count = curves.instants.size();
  std::vector<std::size_t> rows = {0, count - 1};
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = s * count / stretches;
    const std::size_t end = (s + 1) * count / stretches;
    for (const std::size_t c : kThinnedBy) {
      const std::vector<double>& column = curves.columns[c];
      std::optional<std::size_t> low;
      std::optional<std::size_t> high;
      for (std::size_t row = begin; row < end; ++row) {
        if (!std::isfinite(column[row])) continue;
        if (!low || column[row] < column[*low]) low = row;
        if (!high || column[row] > column[*high]) high = row;
      }
      if (low) rows.push_back(*low);
      if (high) rows.push_back(*high);
    }
  }
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  return rows;
}

void AppendFloat(double value, std::string* bytes) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (int shift = 0; shift < 32; shift += 8) *bytes += static_cast<char>(bits >> shift & 0xFF);
}

}  // namespace

std::optional<RunCurves> ReadRunCurves(const fs::path& record, const GroundTruth* truth,
                                       bool with_nees) {
  const fs::path states_file = record / "states.csv";
  const std::vector<InertialState> states =
      ReadStateTable(ReadTextFile(states_file), states_file.string());
  if (states.empty()) return std::nullopt;
  RunCurves curves;
  for (const InertialState& state : states) curves.instants.push_back(state.instant);
  curves.all_instants = states.size();
  for (std::vector<double>& column : curves.columns) column.assign(states.size(), kUnknown);
  for (std::size_t i = 0; i < states.size(); ++i) {
    SetVector(states[i].nav.p_GB, i, kPosition, &curves);
    SetVector(Log(states[i].nav.R_GB), i, kRotation, &curves);
  }
  if (truth != nullptr) SetErrors(states, *truth, &curves);

  const fs::path covariance_file = record / "covariance.csv";
  if (!fs::exists(covariance_file)) return curves;
  const std::vector<RecordedCovariance> covariances =
      ReadCovarianceTable(ReadTextFile(covariance_file), covariance_file.string());
  SetCovariances(covariances, &curves);
  if (truth != nullptr && with_nees) {
    SetNees(ComputeNeesOfTables(states, covariances, *truth), &curves);
  }
  return curves;
}

RunCurves Thinned(const RunCurves& curves, std::size_t most) {
  if (curves.instants.size() <= most) return curves;
  // As many stretches as there is room for: their rows grow with them, nearly always.
  std::size_t stretches = 1;
  for (std::size_t step = std::bit_floor(most); step > 0; step /= 2) {
    if (ExtremeRows(curves, stretches + step).size() <= most) stretches += step;
  }
  const std::vector<std::size_t> rows = ExtremeRows(curves, stretches);
  RunCurves thinned;
  thinned.all_instants = curves.all_instants;
  thinned.alignment = curves.alignment;
  for (const std::size_t row : rows) thinned.instants.push_back(curves.instants[row]);
  for (std::size_t c = 0; c < curves.columns.size(); ++c) {
    for (const std::size_t row : rows) thinned.columns[c].push_back(curves.columns[c][row]);
  }
  return thinned;
}

std::string EncodeCurves(const RunCurves& curves, Timestamp origin) {
  std::string bytes;
  bytes.reserve(curves.instants.size() * kCurveColumns.size() * sizeof(float));
  for (const Timestamp instant : curves.instants) {
    AppendFloat(SecondsBetween(origin, instant), &bytes);
  }
  for (const std::vector<double>& column : curves.columns) {
    for (const double value : column) AppendFloat(value, &bytes);
  }
  return Base64(bytes);
}

}  // namespace duet
