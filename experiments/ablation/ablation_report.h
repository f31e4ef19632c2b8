#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/ablation/ablation.h"
#include "experiments/evaluation_settings.h"

namespace duet {

/// What the tables say besides accuracy and cost.
struct AblationClaims {
  /// NEES, its bands and verdicts, of pose and calibration: of simulations only (DESIGN.md section
  /// 5). A recording's calibration is compared with the recording's own, and nothing is claimed.
  bool consistency = false;
  EvaluationSettings evaluation = {};  ///< that the runs' errors and NEES were taken by
  /// What the motion allows this estimator's cell at the end, over its calibration's components;
  /// empty where there is no prediction.
  std::function<Eigen::VectorXd(const AblationCell& cell)> predicted_sigma;
};

/// The tables of an ablation: accuracy, consistency and cost of every cell, then, for every cell
/// that estimates something, its calibration at the end; at the foot of the first how errors were
/// taken.
[[nodiscard]] std::string AblationText(const std::vector<AblationCell>& cells,
                                       const AblationClaims& claims);
/// The same as JSON.
[[nodiscard]] nlohmann::ordered_json AblationJson(const std::vector<AblationCell>& cells,
                                                  const AblationClaims& claims);

/// One row a run, header included (docs/formats.md: runs.csv).
[[nodiscard]] std::string AblationRunsCsv(const std::vector<AblationCell>& cells,
                                          const AblationClaims& claims);
/// The data behind the convergence curves: one row a run, sample and component (calibration.csv).
[[nodiscard]] std::string AblationCurvesCsv(const std::vector<AblationCell>& cells);

}  // namespace duet
