#include "evaluation/consistency.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "common/support/logging.h"
#include "evaluation/holm.h"
#include "evaluation/statistics.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

struct BlockPlace {
  const char* name;
  int offset;
  int size;
};

BlockPlace PlaceOf(NeesBlock block) {
  switch (block) {
    case NeesBlock::kPose:
      return {"pose", 0, 6};
    case NeesBlock::kOrientation:
      return {"orientation", 0, 3};
    case NeesBlock::kPosition:
      return {"position", 3, 3};
    case NeesBlock::kVelocity:
      return {"velocity", 6, 3};
    case NeesBlock::kGyroBias:
      return {"gyro_bias", 9, 3};
    case NeesBlock::kAccelBias:
      return {"accel_bias", 12, 3};
    case NeesBlock::kState:
      return {"state", 0, 15};
  }
  return {"", 0, 0};
}

/// Values of one block after settling, by stamp, of the runs that have the block.
struct BlockValues {
  std::map<Timestamp, std::vector<double>> by_instant;
  std::vector<double> run_means;
  int missing = 0;
};

BlockValues CollectValues(std::span<const NeesRun> runs, NeesBlock block, double settle_s) {
  const auto b = static_cast<std::size_t>(block);
  BlockValues values;
  for (const NeesRun& run : runs) {
    if (run.failed) continue;
    double sum = 0.0;
    int count = 0;
    int missing = 0;
    for (const NeesSample& sample : run.samples) {
      if (SecondsBetween(run.start, sample.timestamp) < settle_s) continue;
      if (!sample.value[b]) {
        ++missing;
        continue;
      }
      values.by_instant[sample.timestamp].push_back(*sample.value[b]);
      sum += *sample.value[b];
      ++count;
    }
    if (count == 0) continue;
    values.run_means.push_back(sum / count);
    values.missing += missing;
  }
  return values;
}

double Mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

double StandardError(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  if (values.size() < 2) return 0.0;
  const double mean = Mean(values);
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (n - 1.0) / n);
}

BlockConsistency SummarizeBlock(const BlockValues& values, NeesBlock block, double confidence) {
  BlockConsistency result;
  result.block = block;
  result.dof = NeesBlockSize(block);
  result.runs = static_cast<int>(values.run_means.size());
  result.mean = Mean(values.run_means);
  result.standard_error = StandardError(values.run_means);
  result.band = MeanChiSquaredBand(result.dof, result.runs, confidence);
  std::vector<double> instants;
  int in_band = 0;
  for (const auto& [timestamp, of_runs] : values.by_instant) {
    if (of_runs.size() != values.run_means.size()) continue;
    instants.push_back(Mean(of_runs));
    in_band += result.band.Contains(instants.back()) ? 1 : 0;
  }
  result.instants = static_cast<int>(instants.size());
  if (instants.empty()) return result;
  std::sort(instants.begin(), instants.end());
  result.median_instant = SortedQuantile(instants, 0.5);
  result.instants_in_band = static_cast<double>(in_band) / result.instants;
  result.p_value = MeanChiSquaredPValue(result.median_instant, result.dof, result.runs);
  return result;
}

}  // namespace

const char* NeesBlockName(NeesBlock block) { return PlaceOf(block).name; }
int NeesBlockSize(NeesBlock block) { return PlaceOf(block).size; }

std::optional<double> Nees(const Eigen::Ref<const Eigen::VectorXd>& error,
                           const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  CHECK_EQ(covariance.rows(), error.size());
  CHECK_EQ(covariance.cols(), error.size());
  if (!error.allFinite() || !covariance.allFinite()) return std::nullopt;
  if ((covariance.diagonal().array() <= 0.0).any()) return std::nullopt;
  const Eigen::VectorXd per_sigma = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd correlation = per_sigma.asDiagonal() * covariance * per_sigma.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> cholesky(correlation);
  if (cholesky.info() != Eigen::Success) return std::nullopt;
  const Eigen::VectorXd whitened = cholesky.matrixL().solve(per_sigma.cwiseProduct(error));
  return whitened.squaredNorm();
}

NeesSample ComputeNees(Timestamp timestamp, const InertialState& truth,
                       const InertialState& estimate,
                       const Eigen::Ref<const Eigen::MatrixXd>& covariance, bool velocity_known,
                       bool biases_known) {
  CHECK_GE(covariance.rows(), 15);
  CHECK_EQ(covariance.rows(), covariance.cols());
  const Vector15d error = BoxMinus(truth, estimate);
  NeesSample sample;
  sample.timestamp = timestamp;
  for (const NeesBlock block : kNeesBlocks) {
    const BlockPlace place = PlaceOf(block);
    const int end = place.offset + place.size;
    const bool holds_velocity = place.offset <= 6 && end > 6;
    if ((holds_velocity && !velocity_known) || (end > 9 && !biases_known)) continue;
    sample.value[static_cast<std::size_t>(block)] =
        Nees(error.segment(place.offset, place.size),
             covariance.block(place.offset, place.offset, place.size, place.size));
  }
  return sample;
}

ConsistencyReport SummarizeConsistency(std::span<const NeesRun> runs,
                                       const ConsistencyOptions& options) {
  ConsistencyReport report;
  report.runs = static_cast<int>(runs.size());
  for (const NeesRun& run : runs) report.failed += run.failed ? 1 : 0;
  std::vector<double> p_values;
  for (const NeesBlock block : kNeesBlocks) {
    const BlockValues values = CollectValues(runs, block, options.settle_s);
    if (values.run_means.empty()) continue;
    report.not_computed += values.missing;
    report.blocks.push_back(SummarizeBlock(values, block, options.confidence));
    p_values.push_back(report.blocks.back().p_value);
  }
  const std::vector<bool> rejected = HolmRejections(p_values, 1.0 - options.confidence);
  for (std::size_t i = 0; i < rejected.size(); ++i) report.blocks[i].rejected = rejected[i];
  return report;
}

std::vector<NeesOfRun> SummarizeNees(const NeesRun& run, double settle_s) {
  std::vector<NeesOfRun> result;
  for (const NeesBlock block : kNeesBlocks) {
    std::vector<double> values;
    for (const NeesSample& sample : run.samples) {
      const auto& value = sample.value[static_cast<std::size_t>(block)];
      if (value && SecondsBetween(run.start, sample.timestamp) >= settle_s) {
        values.push_back(*value);
      }
    }
    const ErrorSummary summary = Summarize(std::move(values));
    if (summary.count == 0) continue;
    result.push_back({block, summary.count, summary.mean, summary.median});
  }
  return result;
}

std::string ConsistencyText(const ConsistencyReport& report) {
  TextTable table(
      {"NEES", "dof", "runs", "mean", "(s.e.)", "median instant", "band", "in band", "verdict"});
  for (const BlockConsistency& block : report.blocks) {
    table.AddRow({NeesBlockName(block.block), std::to_string(block.dof), std::to_string(block.runs),
                  Number(block.mean, 2), Number(block.standard_error, 2),
                  Number(block.median_instant, 2),
                  "[" + Number(block.band.low, 2) + ", " + Number(block.band.high, 2) + "]",
                  Number(100.0 * block.instants_in_band, 0) + " %",
                  block.rejected ? "inconsistent" : "consistent"});
  }
  return table.Text() + std::to_string(report.runs) + " runs, " + std::to_string(report.failed) +
         " failed, " + std::to_string(report.not_computed) + " values not computed\n";
}

}  // namespace duet
