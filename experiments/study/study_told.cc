#include "experiments/study/study_told.h"

#include <string>

#include "common/measurement/gauge.h"
#include "common/measurement/told_checks.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "experiments/session.h"

namespace duet {
namespace {

/// Which changes to the configuration of a cell are left out.
struct Without {
  bool setting = false;
  bool perturbation = false;
};

// What is wrong; empty where nothing is.
std::string ToldError(const SharedOptions& shared, const std::optional<RigCalibration>& rig) {
  CalibrationPriors priors = shared.calibration;
  const std::string gauge = GaugeError(priors);
  if (!gauge.empty()) return "shared.calibration.imu_frame: " + gauge;
  if (!rig) return "";
  priors.told_errors = {};
  try {
    const RigCalibration told = ToldRig(*rig, priors);
    CheckTold(told, priors);
    // Where no offset moves a time, the stream's own is taken as it is.
    RigCalibration moved;
    if (!priors.told_offset.t_d_s.empty()) moved.t_d_s = told.t_d_s;
    if (!priors.told_offset.t_r_s.empty()) moved.t_r_s = told.t_r_s;
    CheckTimeBounds(moved, shared);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string ErrorOfCell(const StudyPlan& plan, const PlannedRun& cell,
                        const std::optional<RigCalibration>& rig, const Without& without) {
  ConfigSources sources;
  if (without.setting || without.perturbation) {
    StudyPlan changed;
    changed.study = plan.study;
    if (without.setting) changed.study.settings[static_cast<std::size_t>(cell.setting)] = {};
    if (without.perturbation) {
      changed.study.perturbations[static_cast<std::size_t>(cell.perturbation)] = {};
    }
    sources = SourcesOfRun(changed, cell);
  } else {
    sources = SourcesOfRun(plan, cell);
  }
  SharedOptions shared;
  sources.Read("shared", &shared);
  return ToldError(shared, rig);
}

}  // namespace

void RequireToldIsPossible(const StudyPlan& plan, const PlannedRun& cell,
                           const std::optional<RigCalibration>& rig) {
  const std::string error = ErrorOfCell(plan, cell, rig, {});
  if (error.empty()) return;
  const auto still = [&](const Without& without) {
    return !ErrorOfCell(plan, cell, rig, without).empty();
  };
  const StudyFile& study = plan.study;
  const std::string setting =
      "settings." + study.settings[static_cast<std::size_t>(cell.setting)].name;
  const std::string perturbation =
      "perturbations." + study.perturbations[static_cast<std::size_t>(cell.perturbation)].name;
  std::string at_fault = setting + ", " + perturbation;
  if (still({.setting = true, .perturbation = true})) {
    at_fault = "set";
  } else if (still({.setting = true})) {
    if (!still({.perturbation = true})) at_fault = perturbation;
  } else if (still({.perturbation = true})) {
    at_fault = setting;
  }
  throw InputError(study.file, 0, at_fault, "on stream " + plan.StreamOf(cell).name + ": " + error);
}

}  // namespace duet
