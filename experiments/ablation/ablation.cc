#include "experiments/ablation/ablation.h"

#include <algorithm>
#include <bit>
#include <mutex>

#include "common/measurement/told_errors.h"
#include "common/support/logging.h"
#include "experiments/parallel_for.h"

namespace duet {
namespace {

BlockPrior* BlockOf(const std::string& name, CalibrationPriors* priors) {
  const std::vector<std::string>& names = CalibrationBlockNames();
  const auto found = std::find(names.begin(), names.end(), name);
  CHECK(found != names.end()) << "no calibration block is called " << name;
  BlockPrior* const blocks[] = {&priors->T_g,        &priors->T_s,  &priors->T_a,
                                &priors->p_CB,       &priors->R_CB, &priors->intrinsics,
                                &priors->distortion, &priors->t_d,  &priors->t_r};
  return blocks[found - names.begin()];
}

AblationVariant Named(std::vector<std::string> estimated, std::size_t listed) {
  AblationVariant variant{.name = "", .estimated = std::move(estimated)};
  if (variant.estimated.empty()) {
    variant.name = "none";
  } else if (variant.estimated.size() == listed && listed > 1) {
    variant.name = "all";
  } else {
    for (const std::string& block : variant.estimated) {
      variant.name += (variant.name.empty() ? "" : " ") + block;
    }
  }
  return variant;
}

}  // namespace

const std::vector<std::string>& CalibrationBlockNames() {
  static const std::vector<std::string> names = {"T_g",        "T_s",        "T_a", "p_CB", "R_CB",
                                                 "intrinsics", "distortion", "t_d", "t_r"};
  return names;
}

std::vector<AblationVariant> AblationVariants(const std::vector<std::string>& blocks,
                                              AblationDesign design) {
  std::vector<AblationVariant> variants = {Named({}, blocks.size())};
  if (design == AblationDesign::kOneAtATime && blocks.size() > 1) {
    for (const std::string& block : blocks) variants.push_back(Named({block}, blocks.size()));
  }
  if (design == AblationDesign::kCombinations) {
    const unsigned subsets = 1U << blocks.size();
    std::vector<unsigned> order;
    for (unsigned subset = 1; subset + 1 < subsets; ++subset) order.push_back(subset);
    std::stable_sort(order.begin(), order.end(),
                     [](unsigned a, unsigned b) { return std::popcount(a) < std::popcount(b); });
    for (const unsigned subset : order) {
      std::vector<std::string> estimated;
      for (std::size_t i = 0; i < blocks.size(); ++i) {
        if ((subset >> i & 1U) != 0) estimated.push_back(blocks[i]);
      }
      variants.push_back(Named(std::move(estimated), blocks.size()));
    }
  }
  variants.push_back(Named(blocks, blocks.size()));
  return variants;
}

CalibrationPriors PriorsOf(const AblationVariant& variant, CalibrationPriors priors) {
  for (const std::string& name : CalibrationBlockNames()) {
    BlockOf(name, &priors)->estimated =
        std::find(variant.estimated.begin(), variant.estimated.end(), name) !=
        variant.estimated.end();
  }
  return priors;
}

ToldErrors PriorErrorsOf(const std::vector<std::string>& blocks, const CalibrationPriors& priors) {
  return ToldErrorsOfPriors(PriorsOf({.name = "", .estimated = blocks}, priors));
}

std::vector<AblationCell> RunAblation(const AblationPlan& plan, const AblationRunner& run,
                                      const std::function<bool(int)>& progress) {
  const int seeds = plan.last_seed - plan.first_seed + 1;
  std::vector<AblationCell> cells;
  for (const std::string& estimator : plan.estimators) {
    for (const AblationVariant& variant : plan.variants) {
      cells.push_back({.estimator = estimator,
                       .variant = variant,
                       .runs = std::vector<MonteCarloRun>(static_cast<std::size_t>(seeds))});
    }
  }
  std::mutex mutex;
  int done = 0;
  bool go_on = true;
  ParallelFor(static_cast<int>(cells.size()) * seeds, plan.threads, [&](int i) {
    {
      const std::scoped_lock lock(mutex);
      if (!go_on) return;
    }
    AblationCell& cell = cells[static_cast<std::size_t>(i / seeds)];
    const int seed = plan.first_seed + i % seeds;
    cell.runs[static_cast<std::size_t>(i % seeds)] =
        run(cell.estimator, PriorsOf(cell.variant, plan.priors), seed);
    const std::scoped_lock lock(mutex);
    go_on = progress(++done) && go_on;
  });
  if (!go_on) cells.clear();
  return cells;
}

}  // namespace duet
