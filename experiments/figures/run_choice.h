#pragma once

#include <array>
#include <string>
#include <vector>

#include "evaluation/study_result.h"

namespace duet {

/// Which of the runs found a figure is made of, by their places in a study's grid: the names given
/// with --stream, --setting, --perturbation, --seed (whole numbers) and --estimator. No name: any.
struct RunChoice {
  std::vector<std::string> streams = {};
  std::vector<std::string> settings = {};
  std::vector<std::string> perturbations = {};
  std::vector<std::string> seeds = {};
  std::vector<std::string> estimators = {};
};

/// One of the grid's coordinates.
struct RunCoordinate {
  const char* name;  ///< the flag's too
  std::string (*value)(const StudyRun& where);
  std::vector<std::string> RunChoice::*chosen;
  const char* silent;  ///< goes without saying where a study has no other
  bool of_plain_runs;  ///< records that are of no study have it too
};
[[nodiscard]] const std::array<RunCoordinate, 5>& RunCoordinates();

/// What a figure draws of the runs chosen, and so what there is to choose.
enum class DrawnRuns {
  kNone,          ///< it is not made of runs
  kOneStream,     ///< the data that one run had: the same for all estimators and settings
  kOneRun,        ///< one
  kOneCell,       ///< every estimator on one stream, setting, perturbation and seed
  kOverSeeds,     ///< every estimator and seed on one stream, setting and perturbation
  kOverSettings,  ///< of one perturbation every setting too
};

/// Refuses names that could not change the figure (of a coordinate that it does not depend on; a
/// second one where it draws one; one twice). Throws InputError that names the flag.
void RequireEffect(const RunChoice& choice, const std::string& figure, DrawnRuns drawn);

/// The same for a figure that was given something else than runs: `what` it was ("a recording").
void RequireNoChoice(const RunChoice& choice, const std::string& what);

}  // namespace duet
