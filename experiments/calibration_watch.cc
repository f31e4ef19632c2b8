#include "experiments/calibration_watch.h"

#include <cmath>
#include <cstdio>
#include <utility>

#include "common/dataset/csv_reader.h"
#include "common/support/numeric_text.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

std::string Short(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.5g", value);
  return text;
}

}  // namespace

CalibrationWatch::CalibrationWatch(CalibrationLayout layout, RigCalibration told,
                                   const TimeBounds& bounds)
    : layout_(std::move(layout)),
      told_(std::move(told)),
      prior_sigma_(layout_.PriorSigmas()),
      largest_sigmas_(Eigen::VectorXd::Zero(layout_.size())),
      left_after_s_(Eigen::VectorXd::Constant(layout_.size(), -1.0)),
      bound_(Eigen::VectorXd::Constant(layout_.size(), std::numeric_limits<double>::infinity())),
      at_bound_after_s_(Eigen::VectorXd::Constant(layout_.size(), -1.0)) {
  const int t_d = layout_.OffsetOf(CalibrationBlock::kTimeOffset);
  const int t_r = layout_.OffsetOf(CalibrationBlock::kReadoutTime);
  if (t_d >= 0) bound_[t_d] = bounds.max_abs_t_d_s;
  if (t_r >= 0) bound_[t_r] = bounds.max_abs_t_r_s;
}

void CalibrationWatch::Add(const EstimatorOutput& output) {
  const Eigen::Index size = layout_.size();
  constexpr Eigen::Index kState = 15;
  if (size == 0 || output.covariance.rows() != kState + size) return;
  if (value_.size() == 0) first_ = output.state.instant;
  value_ = ComponentValues(output.rig, layout_);
  sigma_ = output.covariance.diagonal().segment(kState, size).cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd moved =
      BoxMinus(output.rig, told_, layout_).cwiseAbs().cwiseQuotient(prior_sigma_);
  const double after_s = SecondsBetween(first_, output.state.instant);
  for (Eigen::Index i = 0; i < size; ++i) {
    largest_sigmas_[i] = std::max(largest_sigmas_[i], moved[i]);
    if (moved[i] > kPriorSigmas && left_after_s_[i] < 0.0) {
      left_after_s_[i] = after_s;
    }
    if (std::abs(value_[i]) >= bound_[i] && at_bound_after_s_[i] < 0.0) {
      at_bound_after_s_[i] = after_s;
    }
  }
}

std::vector<CalibrationWatch::Number> CalibrationWatch::Numbers() const {
  std::vector<Number> numbers;
  if (value_.size() == 0) return numbers;
  const std::vector<std::string> names = layout_.ComponentNames();
  const Eigen::VectorXd told = ComponentValues(told_, layout_);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    numbers.push_back({.name = names[k],
                       .told = told[i],
                       .value = value_[i],
                       .prior_sigma = prior_sigma_[i],
                       .sigma = sigma_[i],
                       .observed = sigma_[i] < kUnobservedShare * prior_sigma_[i],
                       .left_prior_after_s = left_after_s_[i],
                       .largest_sigmas = largest_sigmas_[i],
                       .at_bound_after_s = at_bound_after_s_[i]});
  }
  return numbers;
}

std::string CalibrationWatchText(const std::vector<CalibrationWatch::Number>& numbers) {
  TextTable table({"calibration", "told", "estimate", "sigma", "prior sigma", "verdict"});
  for (const CalibrationWatch::Number& number : numbers) {
    const char* verdict = number.at_bound_after_s >= 0.0     ? "HELD AT ITS BOUND"
                          : number.left_prior_after_s >= 0.0 ? "LEFT ITS PRIOR"
                          : number.observed                  ? "observed"
                          : number.largest_sigmas > CalibrationWatch::kOddSigmas
                              ? "at odds with its prior"
                              : "not observed on this recording";
    table.AddRow({number.name, Short(number.told), Short(number.value), Short(number.sigma),
                  Short(number.prior_sigma), verdict});
  }
  return table.Text();
}

std::string CalibrationCsv(const std::vector<CalibrationWatch::Number>& numbers) {
  std::string text =
      "#told,estimate,sigma,prior sigma,observed,left its prior after [s],largest distance from "
      "the told value [prior sigmas],held at its bound after [s],name\n";
  for (const CalibrationWatch::Number& number : numbers) {
    for (const double value : {number.told, number.value, number.sigma, number.prior_sigma}) {
      AppendNumber(value, &text);
      text += ',';
    }
    text += number.observed ? "1," : "0,";
    AppendNumber(number.left_prior_after_s, &text);
    text += ',';
    AppendNumber(number.largest_sigmas, &text);
    text += ',';
    AppendNumber(number.at_bound_after_s, &text);
    text += "," + number.name + "\n";
  }
  return text;
}

std::vector<CalibrationWatch::Number> ReadCalibrationCsv(std::string_view csv,
                                                         const std::string& file) {
  CsvReader reader(
      csv, file,
      {{"told", "estimate", "sigma", "prior sigma", "observed", "left its prior after [s]",
        "largest distance", "held at its bound after [s]", "name"}});
  std::vector<CalibrationWatch::Number> numbers;
  while (reader.Next()) {
    numbers.push_back({.name = std::string(reader.Text(8)),
                       .told = reader.Number(0),
                       .value = reader.Number(1),
                       .prior_sigma = reader.Number(3),
                       .sigma = reader.Number(2),
                       .observed = reader.Unsigned(4) != 0,
                       .left_prior_after_s = reader.Number(5),
                       .largest_sigmas = reader.Number(6),
                       .at_bound_after_s = reader.Number(7)});
  }
  return numbers;
}

std::vector<std::string> CalibrationWarnings(const std::vector<CalibrationWatch::Number>& numbers) {
  std::vector<std::string> warnings;
  for (const CalibrationWatch::Number& number : numbers) {
    char text[256];
    if (number.left_prior_after_s >= 0.0) {
      std::snprintf(text, sizeof(text),
                    "%s left its prior: more than %g of its standard deviations (%g) from the told "
                    "%g after %.2f s, up to %.1f",
                    number.name.c_str(), CalibrationWatch::kPriorSigmas, number.prior_sigma,
                    number.told, number.left_prior_after_s, number.largest_sigmas);
      warnings.emplace_back(text);
    }
    if (number.at_bound_after_s >= 0.0) {
      std::snprintf(text, sizeof(text),
                    "%s was held at its bound (shared.max_abs_%s_s) after %.2f s: its sigma means "
                    "nothing from there on",
                    number.name.c_str(), number.name.c_str(), number.at_bound_after_s);
      warnings.emplace_back(text);
    }
  }
  return warnings;
}

}  // namespace duet
