#pragma once

#include <functional>
#include <string>
#include <vector>

#include "backends/factory.h"
#include "experiments/simulation/monte_carlo.h"

namespace duet {

/// How the listed blocks of the calibration are switched.
enum class AblationDesign {
  kOneAtATime,    ///< none, each alone, all
  kCombinations,  ///< every subset
  kNoneAndAll,
};

/// One choice of what is estimated; everything else of the listed blocks is fixed at its told
/// value.
struct AblationVariant {
  std::string name;  ///< "none", "t_d", "t_d p_CB", "all"
  std::vector<std::string> estimated;
};

/// Names of the blocks as in the configuration: T_g T_s T_a p_CB R_CB intrinsics distortion t_d
/// t_r.
[[nodiscard]] const std::vector<std::string>& CalibrationBlockNames();

/// The variants of a design over these blocks, in an order from few to many.
[[nodiscard]] std::vector<AblationVariant> AblationVariants(const std::vector<std::string>& blocks,
                                                            AblationDesign design);

/// The priors with exactly the variant's blocks estimated.
[[nodiscard]] CalibrationPriors PriorsOf(const AblationVariant& variant, CalibrationPriors priors);

/// The errors to draw where no perturbation is given: the priors of the listed blocks.
[[nodiscard]] ToldErrors PriorErrorsOf(const std::vector<std::string>& blocks,
                                       const CalibrationPriors& priors);

/// All runs of one variant with one estimator, in order of seed.
struct AblationCell {
  std::string estimator;
  AblationVariant variant;
  std::vector<MonteCarloRun> runs;
};

/// One run: what `priors` estimate, by this estimator, with this seed. Called from several threads.
using AblationRunner = std::function<MonteCarloRun(const std::string& estimator,
                                                   const CalibrationPriors& priors, int seed)>;

struct AblationPlan {
  std::vector<std::string> estimators;
  std::vector<AblationVariant> variants;
  CalibrationPriors priors;  ///< sigmas, gauge and told errors, the same for all
  int first_seed = 1;
  int last_seed = 1;
  int threads = 1;
};

/// Runs the plan, cells by estimator, then variant. `progress` is called with the number of runs
/// done; where it returns false, what is left is not run and an empty result is returned.
[[nodiscard]] std::vector<AblationCell> RunAblation(const AblationPlan& plan,
                                                    const AblationRunner& run,
                                                    const std::function<bool(int)>& progress);

}  // namespace duet
