#include "evaluation/study_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace duet {
namespace {

std::size_t IndexIn(std::vector<std::string>* names, const std::string& name) {
  const auto found = std::find(names->begin(), names->end(), name);
  if (found != names->end()) return static_cast<std::size_t>(found - names->begin());
  names->push_back(name);
  return names->size() - 1;
}

std::size_t IndexIn(std::vector<StudyArm>* arms, const StudyRun& run) {
  for (std::size_t i = 0; i < arms->size(); ++i) {
    const StudyArm& arm = (*arms)[i];
    if (arm.estimator == run.estimator && arm.setting == run.setting &&
        arm.perturbation == run.perturbation) {
      return i;
    }
  }
  arms->push_back({run.estimator, run.setting, run.perturbation, ""});
  return arms->size() - 1;
}

bool Varies(const std::vector<StudyArm>& arms, std::string StudyArm::*axis) {
  return std::any_of(arms.begin(), arms.end(),
                     [&](const StudyArm& arm) { return arm.*axis != arms.front().*axis; });
}

void NameArms(std::vector<StudyArm>* arms) {
  if (arms->empty()) return;
  const bool settings = Varies(*arms, &StudyArm::setting);
  const bool perturbations = Varies(*arms, &StudyArm::perturbation);
  const bool estimators = Varies(*arms, &StudyArm::estimator) || (!settings && !perturbations);
  for (StudyArm& arm : *arms) {
    std::string rest = settings ? arm.setting : "";
    if (perturbations) rest += (rest.empty() ? "" : "; ") + arm.perturbation;
    arm.name = !estimators    ? rest
               : rest.empty() ? arm.estimator
                              : arm.estimator + " (" + rest + ")";
  }
}

}  // namespace

int StudyCell::failed() const {
  return static_cast<int>(
      std::count_if(runs.begin(), runs.end(), [](const StudyRun* run) { return run->failed; }));
}

std::string StudyCell::FailedText() const {
  return runs.empty() ? "-" : std::to_string(failed()) + "/" + std::to_string(runs.size());
}

std::vector<double> StudyCell::Values(std::string_view metric) const {
  std::vector<double> values;
  for (const StudyRun* run : runs) {
    const double value = MetricValue(*run, metric);
    if (!run->failed && std::isfinite(value)) values.push_back(value);
  }
  return values;
}

std::vector<double> StudyCell::Magnitudes(const Metric& metric) const {
  std::vector<double> values = Values(metric.key);
  if (metric.better == Better::kNearZero) {
    for (double& value : values) value = std::abs(value);
  }
  return values;
}

std::vector<double> StudyCell::MeansByInput(std::string_view metric) const {
  struct Sum {
    double sum = 0.0;
    int count = 0;
  };
  std::vector<Sum> sums;
  std::map<std::string, std::size_t> index;
  for (const StudyRun* run : runs) {
    const double value = MetricValue(*run, metric);
    if (run->failed || !std::isfinite(value)) continue;
    const auto [found, is_new] = index.emplace(InputOf(*run), sums.size());
    if (is_new) sums.emplace_back();
    Sum& of_input = sums[found->second];
    of_input.sum += value;
    ++of_input.count;
  }
  std::vector<double> means;
  for (const Sum& of_input : sums) means.push_back(of_input.sum / of_input.count);
  return means;
}

StudyGrid::StudyGrid(const StudyResult& study) : study_(study) {
  for (const StudyRun& run : study.runs) {
    IndexIn(&streams_, run.stream);
    IndexIn(&arms_, run);
  }
  NameArms(&arms_);
  cells_.resize(streams_.size() * arms_.size());
  std::vector<std::set<std::string>> seen(cells_.size());
  for (const StudyRun& run : study.runs) {
    const std::size_t i = IndexIn(&streams_, run.stream) * arms_.size() + IndexIn(&arms_, run);
    if (run.id.empty() || seen[i].insert(run.id).second) cells_[i].runs.push_back(&run);
  }
}

std::string InputOf(const StudyRun& run) {
  return run.stream_id.empty() ? run.stream + " seed " + std::to_string(run.seed) : run.stream_id;
}

double MetricValue(const StudyRun& run, std::string_view metric) {
  for (const auto& [key, value] : run.metrics) {
    if (key == metric) return value;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace duet
