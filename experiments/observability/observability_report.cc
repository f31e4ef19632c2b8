#include "experiments/observability/observability_report.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace duet {
namespace {

using Json = nlohmann::ordered_json;

std::string Format(const char* format, ...) __attribute__((format(printf, 1, 2)));
std::string Format(const char* format, ...) {
  char buffer[256];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof(buffer), format, arguments);
  va_end(arguments);
  return buffer;
}

const char* UnitOf(CalibrationBlock block) {
  switch (block) {
    case CalibrationBlock::kTg:
    case CalibrationBlock::kTa:
    case CalibrationBlock::kDistortion:
      return "1";
    case CalibrationBlock::kTs:
      return "rad/s per m/s^2";
    case CalibrationBlock::kExtrinsicTranslation:
      return "m";
    case CalibrationBlock::kExtrinsicRotation:
      return "rad";
    case CalibrationBlock::kIntrinsics:
      return "px";
    case CalibrationBlock::kTimeOffset:
    case CalibrationBlock::kReadoutTime:
      return "s";
  }
  return "";
}

ObservabilityVerdict Judge(const Observability::Component& component) {
  if (component.unobservable > kUnobservableShare) {
    return ObservabilityVerdict::kUnobservable;
  }
  const double ratio = component.cut / component.prior;
  if (ratio > kUnobservedShare) return ObservabilityVerdict::kNotObserved;
  return ratio > kWeakRatio ? ObservabilityVerdict::kWeak : ObservabilityVerdict::kObserved;
}

std::vector<Observability::Pair> StrongPairs(const Eigen::MatrixXd& covariance) {
  std::vector<Observability::Pair> pairs;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = i + 1; j < covariance.rows(); ++j) {
      const double correlation = covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
      if (std::abs(correlation) < kStrongCorrelation) continue;
      pairs.push_back({static_cast<int>(i), static_cast<int>(j), correlation});
    }
  }
  return pairs;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

std::string DirectionsText(const std::vector<CalibrationDirection>& directions,
                           const std::vector<std::string>& names) {
  std::string text;
  for (const CalibrationDirection& direction : directions) {
    text += Format("  %5.2f  ", direction.ratio) + DirectionText(direction, names) + "\n";
  }
  return text.empty() ? "  none\n" : text;
}

Json DirectionsJson(const std::vector<CalibrationDirection>& directions,
                    const std::vector<std::string>& names) {
  Json json = Json::array();
  for (const CalibrationDirection& direction : directions) {
    Json terms = Json::object();
    for (const CalibrationDirection::Term& term : direction.terms) {
      terms[names[static_cast<std::size_t>(term.component)]] = term.coefficient;
    }
    json.push_back({{"ratio", direction.ratio}, {"terms", terms}});
  }
  return json;
}

Json HistoryJson(const PredictedCovariance& predicted) {
  Json json = Json::array();
  for (const PredictedCovariance::Row& row : predicted.history) {
    json.push_back({{"time_s", row.time_s},
                    {"sigmas", std::vector<double>(row.sigmas.data(),
                                                   row.sigmas.data() + row.sigmas.size())}});
  }
  return json;
}

Json PredictionJson(const PredictedCovariance& predicted) {
  Json covariance = Json::array();
  const Eigen::MatrixXd P = predicted.CalibrationCovariance();
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < P.cols(); ++j) row.push_back(P(i, j));
    covariance.push_back(std::move(row));
  }
  return {{"landmarks", predicted.landmarks},
          {"pixels", predicted.pixels},
          {"pixels_left_out", predicted.left_out},
          {"history", HistoryJson(predicted)},
          {"covariance", covariance}};
}

std::string HistoryText(const Observability& result) {
  std::string text = "  " + std::string(13, ' ');
  for (const PredictedCovariance::Row& row : result.cut.history) {
    text += Format(" %8.4g s", row.time_s);
  }
  text += "\n";
  for (std::size_t i = 0; i < result.components.size(); ++i) {
    text += Format("  %-13s", result.components[i].name.c_str());
    for (const PredictedCovariance::Row& row : result.cut.history) {
      text += Format(" %10.3g", row.sigmas[static_cast<Eigen::Index>(i)]);
    }
    text += "\n";
  }
  return text;
}

}  // namespace

const char* VerdictName(ObservabilityVerdict verdict) {
  switch (verdict) {
    case ObservabilityVerdict::kObserved:
      return "observed";
    case ObservabilityVerdict::kWeak:
      return "weak";
    case ObservabilityVerdict::kNotObserved:
      return "not observed";
    case ObservabilityVerdict::kUnobservable:
      return "unobservable";
  }
  return "";
}

std::vector<std::string> Observability::Names() const {
  std::vector<std::string> names;
  for (const Component& component : components) names.push_back(component.name);
  return names;
}

std::vector<std::string> Observability::Named(ObservabilityVerdict verdict) const {
  std::vector<std::string> names;
  for (const Component& component : components) {
    if (component.verdict == verdict) names.push_back(component.name);
  }
  return names;
}

PredictedCovariance PredictWithWidePriors(const FisherInformation& information,
                                          const FisherInformation::Observer& observer) {
  return information.Predict({.prior_scale = kWidePriors, .at_instants = true}, observer);
}

WeakSpace UnobservableSpace(const PredictedCovariance& wide, const CalibrationLayout& layout) {
  return {wide.CalibrationCovariance(), kWidePriors * layout.PriorSigmas(), kUnobservableRatio};
}

std::vector<std::string> UnobservableComponents(const WeakSpace& space,
                                                const CalibrationLayout& layout) {
  const std::vector<std::string> names = layout.ComponentNames();
  const Eigen::VectorXd ratios = space.ComponentRatios();
  std::vector<std::string> named;
  for (int i = 0; i < layout.size(); ++i) {
    if (ratios[i] > kUnobservableShare) named.push_back(names[static_cast<std::size_t>(i)]);
  }
  return named;
}

Observability AnalyzeObservability(const FisherInformation& information,
                                   const ObservabilityOptions& options,
                                   const FisherInformation::Observer& observer) {
  Observability result;
  result.options = options;
  result.duration_s = information.duration_s();
  result.frames = information.frames();
  result.frames_at_rest = information.frames_at_rest();
  result.tracks = information.tracks();
  result.not_triangulated = information.not_triangulated();

  int before = 0;
  const auto count = [&](int frame) {
    if (observer) observer(before + frame);
  };
  const auto predict = [&](const InformationOptions& each) {
    PredictedCovariance predicted = information.Predict(each, count);
    before += information.frames();
    return predicted;
  };
  result.cut = predict({.window_frames = options.window_frames,
                        .min_observations = options.min_observations,
                        .times_s = options.times_s});
  result.batch = predict({.times_s = options.times_s});
  result.wide = PredictWithWidePriors(information, count);

  const CalibrationLayout& layout = information.layout();
  const Eigen::VectorXd priors = layout.PriorSigmas();
  const std::vector<std::string> names = layout.ComponentNames();
  const WeakSpace wide = UnobservableSpace(result.wide, layout);
  const Eigen::VectorXd unobservable = wide.ComponentRatios();
  for (const CalibrationLayout::Entry& entry : layout.entries()) {
    for (int k = 0; k < entry.size; ++k) {
      const int i = entry.offset + k;
      Observability::Component component{.name = names[static_cast<std::size_t>(i)],
                                         .unit = UnitOf(entry.block),
                                         .prior = priors[i],
                                         .cut = result.cut.history.back().sigmas[i],
                                         .batch = result.batch.history.back().sigmas[i],
                                         .unobservable = unobservable[i]};
      component.verdict = Judge(component);
      result.components.push_back(std::move(component));
    }
  }
  const Eigen::MatrixXd cut = result.cut.CalibrationCovariance();
  result.unobservable = wide.Directions();
  result.untold = WeakSpace(cut, priors, std::sqrt(kUntoldVariance)).Directions();
  result.correlated = StrongPairs(cut);
  return result;
}

std::string ObservabilityText(const Observability& result) {
  std::string text = Format(
      "%d frames over %.1f s, %d at rest; %d tracks, %d without a point (no parallax, or too far "
      "off)\n",
      result.frames, result.duration_s, result.frames_at_rest, result.tracks,
      result.not_triangulated);
  text += Format(
      "tracks cut at %d frames (pieces of %d pixels or more): %d landmarks, %d pixels; whole: %d "
      "landmarks, %d pixels\n\n",
      result.options.window_frames, result.options.min_observations, result.cut.landmarks,
      result.cut.pixels, result.batch.landmarks, result.batch.pixels);

  text += "expected standard deviation at the end\n";
  text += "  component         prior        cut      whole  cut/prior  verdict\n";
  for (const Observability::Component& each : result.components) {
    text += Format("  %-13s %9.3g  %9.3g  %9.3g  %9.3f  %s\n", each.name.c_str(), each.prior,
                   each.cut, each.batch, each.cut / each.prior, VerdictName(each.verdict));
  }
  text += Format(
      "  observed: down to %g of the prior or less; weak: to %g; not observed: hardly;\n"
      "  unobservable: part of a combination that nothing but priors holds\n\n",
      kWeakRatio, kUnobservedShare);

  const std::vector<std::string> names = result.Names();
  text += Format(
      "combinations that nothing but priors holds: of priors %g times as wide this share is left "
      "(in prior sigmas)\n",
      kWidePriors);
  text += DirectionsText(result.unobservable, names) + "\n";
  text += Format(
      "combinations of which more than %g of the prior variance is left, cut tracks (share of the "
      "sigma; in prior sigmas)\n",
      kUntoldVariance);
  text += DirectionsText(result.untold, names) + "\n";
  text +=
      Format("pairs that correlate by more than %g at the end, cut tracks\n", kStrongCorrelation);
  for (const Observability::Pair& pair : result.correlated) {
    text += Format("  %6.3f  %s, %s\n", pair.correlation,
                   names[static_cast<std::size_t>(pair.first)].c_str(),
                   names[static_cast<std::size_t>(pair.second)].c_str());
  }
  if (result.correlated.empty()) text += "  none\n";
  text += "\nexpected standard deviation after\n" + HistoryText(result);

  const auto sentence = [&](const char* words, ObservabilityVerdict verdict) {
    const std::vector<std::string> named = result.Named(verdict);
    if (!named.empty()) text += words + Joined(named) + "\n";
  };
  text += "\n";
  sentence("can calibrate:    ", ObservabilityVerdict::kObserved);
  sentence("weakly:           ", ObservabilityVerdict::kWeak);
  sentence("not in this time: ", ObservabilityVerdict::kNotObserved);
  sentence("cannot:           ", ObservabilityVerdict::kUnobservable);
  return text;
}

nlohmann::ordered_json ObservabilityJson(const Observability& result) {
  const std::vector<std::string> names = result.Names();
  Json components = Json::array();
  for (const Observability::Component& each : result.components) {
    components.push_back({{"name", each.name},
                          {"unit", each.unit},
                          {"prior_sigma", each.prior},
                          {"sigma_cut", each.cut},
                          {"sigma_whole", each.batch},
                          {"unobservable_share", each.unobservable},
                          {"information_cut", each.CutInformation()},
                          {"information_whole", each.BatchInformation()},
                          {"verdict", VerdictName(each.verdict)}});
  }
  Json pairs = Json::array();
  for (const Observability::Pair& pair : result.correlated) {
    pairs.push_back({{"first", names[static_cast<std::size_t>(pair.first)]},
                     {"second", names[static_cast<std::size_t>(pair.second)]},
                     {"correlation", pair.correlation}});
  }
  return {{"frames", result.frames},
          {"duration_s", result.duration_s},
          {"frames_at_rest", result.frames_at_rest},
          {"tracks", result.tracks},
          {"not_triangulated", result.not_triangulated},
          {"window_frames", result.options.window_frames},
          {"min_observations", result.options.min_observations},
          {"thresholds",
           {{"wide_priors", kWidePriors},
            {"unobservable_ratio", kUnobservableRatio},
            {"unobservable_share", kUnobservableShare},
            {"not_observed_ratio", kUnobservedShare},
            {"weak_ratio", kWeakRatio},
            {"untold_variance", kUntoldVariance},
            {"strong_correlation", kStrongCorrelation}}},
          {"components", components},
          {"unobservable", DirectionsJson(result.unobservable, names)},
          {"untold", DirectionsJson(result.untold, names)},
          {"correlated", pairs},
          {"cut", PredictionJson(result.cut)},
          {"whole", PredictionJson(result.batch)}};
}

}  // namespace duet
