#include "evaluation/calibration_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/support/logging.h"
#include "evaluation/consistency.h"
#include "evaluation/holm.h"
#include "evaluation/statistics.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

constexpr double kConfidence = 0.99;
/// A mean NEES this close to its expectation, as a share, is taken as it is, whatever the band
/// says: with many seeds the band becomes narrower than what a linearization can hold.
constexpr double kNeesTolerance = 0.25;
constexpr double kConvergedShareOfPrior = 0.2;
constexpr double kConvergedSigmas = 3.0;

int CountOutsidePrior(const RigCalibration& estimate, const RigCalibration& told,
                      const CalibrationLayout& layout, double sigmas) {
  const Eigen::ArrayXd moved = BoxMinus(estimate, told, layout).array().abs();
  return static_cast<int>((moved > sigmas * layout.PriorSigmas().array()).count());
}

double Rms(const Eigen::VectorXd& v) {
  return v.size() == 0 ? 0.0 : std::sqrt(v.squaredNorm() / static_cast<double>(v.size()));
}

// Sums of squares over runs.
struct Sums {
  double error = 0.0;
  double sigma = 0.0;
  double prior = 0.0;
  double over_sigma = 0.0;
  double over_predicted = 0.0;
  double nees = 0.0;
  int numbers = 0;
  int runs = 0;
  std::vector<double> convergence_s = {};
};

double RootMean(double sum, int count) { return std::sqrt(sum / std::max(count, 1)); }

CalibrationBlockSummary Finish(const std::string& name, int dof, bool predicted, const Sums& sums) {
  CalibrationBlockSummary block{.name = name, .dof = dof, .runs = sums.runs};
  block.rms_error = RootMean(sums.error, sums.numbers);
  block.rms_sigma = RootMean(sums.sigma, sums.numbers);
  block.prior_sigma = RootMean(sums.prior, sums.numbers);
  block.error_over_sigma = RootMean(sums.over_sigma, sums.numbers);
  if (predicted) block.error_over_predicted = RootMean(sums.over_predicted, sums.numbers);
  block.mean_nees = sums.nees / std::max(sums.runs, 1);
  block.convergence_s = Summarize(sums.convergence_s).median;
  if (sums.runs > 0) {
    block.band = MeanChiSquaredBand(dof, sums.runs, kConfidence);
    block.p_value = MeanChiSquaredPValue(block.mean_nees, dof, sums.runs);
  }
  return block;
}

}  // namespace

CalibrationErrors::CalibrationErrors(CalibrationLayout layout, RigCalibration true_rig,
                                     double interval_s)
    : layout_(std::move(layout)), true_rig_(std::move(true_rig)), interval_s_(interval_s) {}

void CalibrationErrors::Add(double t_s, const RigCalibration& estimate,
                            const Eigen::Ref<const Eigen::MatrixXd>& covariance) {
  CHECK_EQ(covariance.rows(), layout_.size());
  if (last_is_extra_) {
    samples_.pop_back();
    estimates_.pop_back();
  }
  last_is_extra_ = !samples_.empty() && t_s < samples_.back().t_s + interval_s_ - 1e-9;
  samples_.push_back({t_s, BoxMinus(true_rig_, estimate, layout_),
                      covariance.diagonal().cwiseMax(0.0).cwiseSqrt()});
  estimates_.push_back(estimate);
  covariance_ = covariance;
}

std::optional<double> CalibrationErrors::Nees() const {
  return empty() ? std::nullopt : duet::Nees(error(), covariance_);
}

std::optional<double> CalibrationErrors::BlockNees(const CalibrationLayout::Entry& entry) const {
  if (empty()) return std::nullopt;
  return duet::Nees(error().segment(entry.offset, entry.size),
                    covariance_.block(entry.offset, entry.offset, entry.size, entry.size));
}

std::optional<double> CalibrationErrors::ConvergenceTime(
    const CalibrationLayout::Entry& entry) const {
  if (empty()) return std::nullopt;
  const Eigen::VectorXd prior = layout_.PriorSigmas().segment(entry.offset, entry.size);
  const auto scaled_rms = [&](const Eigen::VectorXd& values) {
    return Rms(values.segment(entry.offset, entry.size).cwiseQuotient(prior));
  };
  const double bound =
      std::max(kConvergedShareOfPrior, kConvergedSigmas * scaled_rms(samples_.back().sigma));
  std::optional<double> since;
  for (const CalibrationSample& sample : samples_) {
    if (scaled_rms(sample.error) > bound) {
      since.reset();
    } else if (!since) {
      since = sample.t_s;
    }
  }
  return since;
}

double CalibrationErrors::ShareOutsidePrior(const RigCalibration& told, double sigmas) const {
  double outside = 0.0;
  for (const RigCalibration& estimate : estimates_) {
    outside += CountOutsidePrior(estimate, told, layout_, sigmas);
  }
  return outside / std::max<double>(1.0, static_cast<double>(estimates_.size()) * layout_.size());
}

int CalibrationErrors::CountOutsidePriorAtEnd(const RigCalibration& told, double sigmas) const {
  return CountOutsidePrior(estimates_.back(), told, layout_, sigmas);
}

std::vector<CalibrationBlockSummary> SummarizeCalibration(
    std::span<const CalibrationErrors* const> runs, const Eigen::VectorXd& predicted_sigma,
    const std::vector<double>& further_p_values) {
  std::vector<CalibrationBlockSummary> blocks;
  const CalibrationLayout* layout = nullptr;
  for (const CalibrationErrors* run : runs) {
    if (!run->empty() && layout == nullptr) layout = &run->layout();
  }
  if (layout == nullptr || layout->size() == 0) return blocks;
  const bool predicted = predicted_sigma.size() == layout->size();
  const Eigen::VectorXd prior = layout->PriorSigmas();

  std::vector<CalibrationLayout::Entry> parts = layout->entries();
  const int whole = static_cast<int>(parts.size());
  for (int i = 0; i <= whole; ++i) {
    const int offset = i == whole ? 0 : parts[i].offset;
    const int size = i == whole ? layout->size() : parts[i].size;
    Sums sums;
    for (const CalibrationErrors* run : runs) {
      if (run->empty()) continue;
      const std::optional<double> nees = i == whole ? run->Nees() : run->BlockNees(parts[i]);
      if (!nees) continue;
      const Eigen::VectorXd error = run->error().segment(offset, size);
      const Eigen::VectorXd sigma = run->sigma().segment(offset, size);
      sums.error += error.squaredNorm();
      sums.sigma += sigma.squaredNorm();
      sums.prior += prior.segment(offset, size).squaredNorm();
      sums.over_sigma += error.cwiseQuotient(sigma).squaredNorm();
      if (predicted) {
        sums.over_predicted +=
            error.cwiseQuotient(predicted_sigma.segment(offset, size)).squaredNorm();
      }
      sums.nees += *nees;
      sums.numbers += size;
      ++sums.runs;
      if (i < whole) {
        sums.convergence_s.push_back(
            run->ConvergenceTime(parts[i]).value_or(std::numeric_limits<double>::infinity()));
      }
    }
    blocks.push_back(
        Finish(i == whole ? "calibration" : BlockName(parts[i]), size, predicted, sums));
  }

  std::vector<double> p_values = further_p_values;
  for (const CalibrationBlockSummary& block : blocks) p_values.push_back(block.p_value);
  const std::vector<bool> rejected = HolmRejections(p_values, 1.0 - kConfidence);
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool far = std::abs(blocks[i].mean_nees / blocks[i].dof - 1.0) > kNeesTolerance;
    blocks[i].rejected = blocks[i].runs > 0 && rejected[further_p_values.size() + i] && far;
  }
  return blocks;
}

std::string CalibrationText(const std::vector<CalibrationBlockSummary>& blocks) {
  const bool predicted = !blocks.empty() && blocks.front().error_over_predicted.has_value();
  std::vector<std::string> header = {
      "calibration at the end", "runs", "prior", "error rms", "reported", "error/reported"};
  if (predicted) header.emplace_back("error/predicted");
  for (const char* title : {"NEES", "dof", "99 % band", "verdict", "settled [s]"}) {
    header.emplace_back(title);
  }
  TextTable table(header);
  const auto scientific = [](double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.2e", value);
    return std::string(text);
  };
  for (const CalibrationBlockSummary& block : blocks) {
    const bool whole = block.name == "calibration";  // units differ
    std::vector<std::string> row = {block.name,
                                    std::to_string(block.runs),
                                    whole ? "" : scientific(block.prior_sigma),
                                    whole ? "" : scientific(block.rms_error),
                                    whole ? "" : scientific(block.rms_sigma),
                                    Number(block.error_over_sigma, 2)};
    if (predicted) row.push_back(Number(block.error_over_predicted.value_or(std::nan("")), 2));
    row.push_back(Number(block.mean_nees, 2));
    row.push_back(std::to_string(block.dof));
    row.push_back("[" + Number(block.band.low, 2) + ", " + Number(block.band.high, 2) + "]");
    row.emplace_back(block.runs == 0  ? "no covariance"
                     : block.rejected ? "INCONSISTENT"
                                      : "consistent");
    row.push_back(whole ? "" : Number(block.convergence_s, 1));
    table.AddRow(row);
  }
  return table.Text();
}

}  // namespace duet
