#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/ablation/ablation.h"

namespace duet {

/// The tables of an ablation: accuracy, consistency and cost of every cell, then, for every cell
/// that estimates something, its calibration at the end. `consistency`: NEES is claimed of the pose
/// (simulation only). `predicted_sigma`: what the motion allows this estimator's cell at the end,
/// over its calibration's components; empty where there is no prediction.
using PredictedSigma = std::function<Eigen::VectorXd(const AblationCell& cell)>;
[[nodiscard]] std::string AblationText(const std::vector<AblationCell>& cells, bool consistency,
                                       const PredictedSigma& predicted_sigma);
/// The same as JSON.
[[nodiscard]] nlohmann::ordered_json AblationJson(const std::vector<AblationCell>& cells,
                                                  bool consistency,
                                                  const PredictedSigma& predicted_sigma);

/// One row a run, header included (docs/formats.md: runs.csv).
[[nodiscard]] std::string AblationRunsCsv(const std::vector<AblationCell>& cells);
/// The data behind the convergence curves: one row a run, sample and component (calibration.csv).
[[nodiscard]] std::string AblationCurvesCsv(const std::vector<AblationCell>& cells);

}  // namespace duet
