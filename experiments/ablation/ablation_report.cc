#include "experiments/ablation/ablation_report.h"

#include <cmath>
#include <cstdio>
#include <optional>

#include "common/support/numeric_text.h"
#include "evaluation/proportion.h"
#include "evaluation/statistics.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

/// SummarizeCalibration's name of all blocks together.
constexpr const char* kWholeCalibration = "calibration";
constexpr double kPriorSigmas = 3.0;
/// How often a told error that is drawn from its prior is larger than that.
constexpr double kOutsidePriorByChance = 0.0026998;

/// What a cell's runs say together.
struct CellSummary {
  int failed = 0;
  ErrorSummary position_m;
  ErrorSummary orientation_deg;
  ErrorSummary frame_ms;
  double coverage_s = 0.0;  ///< the smallest
  /// Of all runs, failed ones too.
  int frames = 0;
  int dead_reckoned = 0;
  /// Of all numbers, instants and runs, failed ones too: how often the estimate is further than
  /// kPriorSigmas of its prior from the told value. Told errors drawn from the prior make it 0.0027
  /// at most. NaN where nothing was estimated.
  double outside_prior = std::nan("");
  /// The same at the end of each run, failed ones too: how many of the numbers of all runs, and the
  /// probability of as many or more where an estimate is as far off as its told value was drawn.
  int outside_at_end = 0;
  int numbers_at_end = 0;
  double chance_of_outside = 1.0;
  std::optional<BlockConsistency> pose;
  std::vector<CalibrationBlockSummary> calibration;
};

CellSummary SummarizeCell(const AblationCell& cell, const AblationClaims& claims) {
  CellSummary summary;
  std::vector<double> position_m;
  std::vector<double> orientation_deg;
  std::vector<double> frame_ms;
  bool first = true;
  double outside_samples = 0.0;
  double samples = 0.0;
  for (const MonteCarloRun& run : cell.runs) {
    frame_ms.push_back(run.frame_ms_median);
    summary.coverage_s = first ? run.coverage_s : std::min(summary.coverage_s, run.coverage_s);
    first = false;
    summary.frames += run.frames;
    summary.dead_reckoned += run.dead_reckoned;
    if (!run.calibration.empty()) {
      const auto of_run = static_cast<double>(run.calibration.samples().size());
      samples += of_run;
      outside_samples += of_run * run.calibration.ShareOutsidePrior(run.told_rig, kPriorSigmas);
      summary.outside_at_end += run.calibration.CountOutsidePriorAtEnd(run.told_rig, kPriorSigmas);
      summary.numbers_at_end += run.calibration.layout().size();
    }
    if (run.failed) {
      ++summary.failed;
      continue;
    }
    if (!std::isfinite(run.ate_position_m)) continue;  // a truth that stands still
    position_m.push_back(run.ate_position_m);
    orientation_deg.push_back(run.ate_orientation_deg);
  }
  if (samples > 0.0) summary.outside_prior = outside_samples / samples;
  if (summary.numbers_at_end > 0) {
    summary.chance_of_outside =
        BinomialUpperTail(summary.outside_at_end, summary.numbers_at_end, kOutsidePriorByChance);
  }
  summary.position_m = Summarize(position_m);
  summary.orientation_deg = Summarize(orientation_deg);
  summary.frame_ms = Summarize(frame_ms);
  std::vector<double> further_p_values;
  if (claims.consistency) {
    for (const BlockConsistency& block :
         SummarizeRuns(cell.runs, claims.evaluation.nees_settle_s).blocks) {
      if (block.block != NeesBlock::kPose) continue;
      summary.pose = block;
      further_p_values.push_back(block.p_value);
    }
  }
  summary.calibration =
      SummarizeCalibrationOfRuns(cell.runs, claims.predicted_sigma(cell), further_p_values);
  return summary;
}

std::string Scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2e", value);
  return text;
}

std::string CountOf(int count, int of) {
  return of == 0 ? "-" : std::to_string(count) + " of " + std::to_string(of);
}

nlohmann::ordered_json Spread(const ErrorSummary& errors) {
  return {{"median", errors.median},
          {"p25", errors.p25},
          {"p75", errors.p75},
          {"p95", errors.p95},
          {"max", errors.max}};
}

// Of a recording: without what only a known truth allows to say.
std::string OwnCalibrationText(const std::vector<CalibrationBlockSummary>& blocks) {
  TextTable table({"calibration, against the recording's own", "runs", "prior", "difference rms",
                   "reported", "settled [s]"});
  for (const CalibrationBlockSummary& block : blocks) {
    if (block.name == kWholeCalibration) continue;  // units differ
    table.AddRow({block.name, std::to_string(block.runs), Scientific(block.prior_sigma),
                  Scientific(block.rms_error), Scientific(block.rms_sigma),
                  Number(block.convergence_s, 1)});
  }
  return table.Text();
}

nlohmann::ordered_json OwnCalibrationJson(const CalibrationBlockSummary& block) {
  nlohmann::ordered_json json = {{"runs", block.runs},
                                 {"prior_sigma", block.prior_sigma},
                                 {"rms_difference", block.rms_error},
                                 {"rms_reported_sigma", block.rms_sigma}};
  if (std::isfinite(block.convergence_s)) json["settled_s"] = block.convergence_s;
  return json;
}

nlohmann::ordered_json CalibrationJson(const CalibrationBlockSummary& block) {
  nlohmann::ordered_json json = {{"runs", block.runs},
                                 {"dof", block.dof},
                                 {"prior_sigma", block.prior_sigma},
                                 {"rms_error", block.rms_error},
                                 {"rms_reported_sigma", block.rms_sigma},
                                 {"error_over_reported", block.error_over_sigma}};
  if (block.error_over_predicted) json["error_over_predicted"] = *block.error_over_predicted;
  json["mean_nees"] = block.mean_nees;
  json["band_99"] = {block.band.low, block.band.high};
  json["p_value"] = block.p_value;
  json["rejected"] = block.rejected;
  if (std::isfinite(block.convergence_s)) json["settled_s"] = block.convergence_s;
  return json;
}

// How the errors of the table were taken.
std::string ErrorsFoot(const AblationClaims& claims) {
  const EvaluationSettings& evaluation = claims.evaluation;
  std::string text = std::string("Errors after alignment ") +
                     AlignmentModeName(evaluation.alignment) +
                     ", positions and orientations apart; ";
  if (claims.consistency) {
    return text + "truth at the state's instant; states from " +
           FormatNumber(evaluation.nees_settle_s) + " s after the first on.\n";
  }
  if (evaluation.association == AssociationMode::kInterpolated) {
    return text + "truth interpolated over at most " + FormatNumber(evaluation.max_truth_gap_s) +
           " s; all states.\n";
  }
  return text + "pairs of \"" + AssociationModeName(evaluation.association) +
         "\" (nearest in time), for comparing with that program only.\n";
}

}  // namespace

std::string AblationText(const std::vector<AblationCell>& cells, const AblationClaims& claims) {
  std::vector<std::string> header = {
      "estimated",     "runs",       "failed",        "ATE [m]",
      "p95 [m]",       "ATE [deg]",  "p95 [deg]",     "least covered [s]",
      "dead reckoned", "frame [ms]", "off > 3 sigma", "by chance"};
  if (claims.consistency) header.emplace_back("pose NEES (6)");
  TextTable table(header);
  std::string details;
  const std::string* estimator = nullptr;
  for (const AblationCell& cell : cells) {
    const CellSummary summary = SummarizeCell(cell, claims);
    if (estimator == nullptr || *estimator != cell.estimator) table.AddSection(cell.estimator);
    estimator = &cell.estimator;
    std::vector<std::string> row = {
        cell.variant.name,
        std::to_string(cell.runs.size()),
        std::to_string(summary.failed),
        Number(summary.position_m.median, 4),
        Number(summary.position_m.p95, 4),
        Number(summary.orientation_deg.median, 3),
        Number(summary.orientation_deg.p95, 3),
        Number(summary.coverage_s, 1),
        CountOf(summary.dead_reckoned, summary.frames),
        Number(summary.frame_ms.median, 2),
        CountOf(summary.outside_at_end, summary.numbers_at_end),
        summary.numbers_at_end > 0 ? Number(summary.chance_of_outside, 3) : "-"};
    if (claims.consistency) row.push_back(summary.pose ? Number(summary.pose->mean, 2) : "-");
    table.AddRow(row);
    if (!summary.calibration.empty()) {
      details += "\n" + cell.estimator + ", estimated: " + cell.variant.name + "\n" +
                 (claims.consistency ? CalibrationText(summary.calibration)
                                     : OwnCalibrationText(summary.calibration));
    }
  }
  return table.Text() + ErrorsFoot(claims) + details;
}

nlohmann::ordered_json AblationJson(const std::vector<AblationCell>& cells,
                                    const AblationClaims& claims) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const AblationCell& cell : cells) {
    const CellSummary summary = SummarizeCell(cell, claims);
    nlohmann::ordered_json entry = {
        {"estimator", cell.estimator},
        {"variant", cell.variant.name},
        {"estimated", cell.variant.estimated},
        {"runs", cell.runs.size()},
        {"failed", summary.failed},
        {"alignment", AlignmentModeName(claims.evaluation.alignment)},
        {"ate_position_m", Spread(summary.position_m)},
        {"ate_orientation_deg", Spread(summary.orientation_deg)},
        {"least_coverage_s", summary.coverage_s},
        {"dead_reckoned", {{"frames", summary.dead_reckoned}, {"of", summary.frames}}},
        {"frame_ms", Spread(summary.frame_ms)},
        {"outside_3_prior_sigmas", summary.outside_prior},
        {"outside_3_prior_sigmas_at_end",
         {{"count", summary.outside_at_end},
          {"of", summary.numbers_at_end},
          {"by_chance", summary.chance_of_outside}}}};
    if (summary.pose) {
      entry["pose_nees"] = {{"mean", summary.pose->mean},
                            {"median_instant", summary.pose->median_instant},
                            {"rejected", summary.pose->rejected}};
    }
    for (const CalibrationBlockSummary& block : summary.calibration) {
      if (claims.consistency) {
        entry["calibration"][block.name] = CalibrationJson(block);
      } else if (block.name != kWholeCalibration) {
        entry["against_own_calibration"][block.name] = OwnCalibrationJson(block);
      }
    }
    json.push_back(entry);
  }
  return json;
}

std::string AblationRunsCsv(const std::vector<AblationCell>& cells, const AblationClaims& claims) {
  std::string text =
      "#estimator,estimated,seed,failed,coverage [s],frames,dead reckoned,ate position [m],ate "
      "orientation [deg],"
      "calibration nees,calibration size,frame median [ms],frame p99 [ms]\n";
  for (const AblationCell& cell : cells) {
    for (const MonteCarloRun& run : cell.runs) {
      text += cell.estimator + "," + cell.variant.name + "," + std::to_string(run.seed) + "," +
              (run.failed ? "1" : "0") + "," + FormatNumber(run.coverage_s) + "," +
              std::to_string(run.frames) + "," + std::to_string(run.dead_reckoned);
      const std::optional<double> nees =
          claims.consistency ? run.calibration.Nees() : std::optional<double>();
      for (const double value :
           {run.ate_position_m, run.ate_orientation_deg, nees.value_or(std::nan(""))}) {
        text += "," + (std::isfinite(value) ? FormatNumber(value) : "");
      }
      text += "," + std::to_string(run.calibration.layout().size());
      text += "," + FormatNumber(run.frame_ms_median) + "," + FormatNumber(run.frame_ms_p99) + "\n";
    }
  }
  return text;
}

std::string AblationCurvesCsv(const std::vector<AblationCell>& cells) {
  std::string text = "#estimator,estimated,seed,time [s],component,error,sigma\n";
  for (const AblationCell& cell : cells) {
    for (const MonteCarloRun& run : cell.runs) {
      const std::vector<std::string> names = run.calibration.layout().ComponentNames();
      const std::string head =
          cell.estimator + "," + cell.variant.name + "," + std::to_string(run.seed) + ",";
      for (const CalibrationSample& sample : run.calibration.samples()) {
        const std::string row = head + FormatNumber(sample.t_s) + ",";
        for (std::size_t i = 0; i < names.size(); ++i) {
          const auto k = static_cast<Eigen::Index>(i);
          text += row + names[i] + "," + FormatNumber(sample.error[k]) + "," +
                  FormatNumber(sample.sigma[k]) + "\n";
        }
      }
    }
  }
  return text;
}

}  // namespace duet
