#pragma once

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "experiments/observability/fisher_information.h"
#include "experiments/observability/unobservable_directions.h"

namespace duet {

/// The priors of the second look are so many times as wide: what is left then of a direction is
/// either a large share of them (nothing but priors holds it) or none to speak of.
inline constexpr double kWidePriors = 1000.0;
/// Directions are unobservable where more than this share of the wide priors' standard deviation is
/// left. Directions that nothing holds have 0.35 to 1 (they may share what is left with biases),
/// others their standard deviation in wide prior sigmas: below 0.2 wherever the measurements alone
/// tell them to 200 sigmas of the actual prior.
inline constexpr double kUnobservableRatio = 0.2;
/// A component is unobservable that makes up this share of such a direction.
inline constexpr double kUnobservableShare = 0.1;
/// With the priors as they are: weak above this ratio of expected and prior standard deviation, not
/// observed above kUnobservedShare.
inline constexpr double kWeakRatio = 0.5;
/// A combination is not told where more than this share of its prior variance is left.
inline constexpr double kUntoldVariance = 0.8;
inline constexpr double kStrongCorrelation = 0.95;

enum class ObservabilityVerdict { kObserved, kWeak, kNotObserved, kUnobservable };
/// "observed", "weak", "not observed", "unobservable".
[[nodiscard]] const char* VerdictName(ObservabilityVerdict verdict);

struct ObservabilityOptions {
  int window_frames = 20;    ///< of the cut tracks (InformationOptions)
  int min_observations = 4;  ///< of the cut tracks
  std::vector<double> times_s = {5.0, 10.0, 20.0, 40.0};
};

/// What a recording can calibrate.
struct Observability {
  struct Component {
    std::string name;
    std::string unit;
    double prior = 0.0;  ///< sigma
    double cut = 0.0;    ///< expected sigma at the end, tracks cut at the estimators' window
    double batch = 0.0;  ///< the same, whole tracks
    /// Share of a wide prior's sigma that unobservable directions leave to it.
    double unobservable = 0.0;
    ObservabilityVerdict verdict = ObservabilityVerdict::kObserved;

    /// What the measurements say of it, all else eliminated: 1/sigma^2 beyond the prior's.
    [[nodiscard]] double CutInformation() const {
      return 1.0 / (cut * cut) - 1.0 / (prior * prior);
    }
    [[nodiscard]] double BatchInformation() const {
      return 1.0 / (batch * batch) - 1.0 / (prior * prior);
    }
  };
  struct Pair {
    int first;
    int second;
    double correlation;
  };

  ObservabilityOptions options;
  std::vector<Component> components;
  std::vector<CalibrationDirection> unobservable;  ///< by the wide priors
  std::vector<CalibrationDirection> untold;        ///< by the priors as they are, cut tracks
  std::vector<Pair> correlated;                    ///< cut tracks, at the end
  PredictedCovariance cut;
  PredictedCovariance batch;
  PredictedCovariance wide;

  double duration_s = 0.0;
  int frames = 0;
  int frames_at_rest = 0;
  int tracks = 0;
  int not_triangulated = 0;

  [[nodiscard]] std::vector<std::string> Names() const;
  [[nodiscard]] std::vector<std::string> Named(ObservabilityVerdict verdict) const;
};

/// The directions that nothing but priors holds, and the components that they make up.
[[nodiscard]] WeakSpace UnobservableSpace(const PredictedCovariance& wide,
                                          const CalibrationLayout& layout);
[[nodiscard]] std::vector<std::string> UnobservableComponents(const WeakSpace& space,
                                                              const CalibrationLayout& layout);
/// How the first of them is had.
[[nodiscard]] PredictedCovariance PredictWithWidePriors(
    const FisherInformation& information, const FisherInformation::Observer& observer = nullptr);

/// Three times through the recording: cut tracks; whole tracks; whole tracks with wide priors and
/// pixels linearized at their states' instants.
/// `observer` counts the frames of all three.
[[nodiscard]] Observability AnalyzeObservability(
    const FisherInformation& information, const ObservabilityOptions& options,
    const FisherInformation::Observer& observer = nullptr);

/// For a terminal.
[[nodiscard]] std::string ObservabilityText(const Observability& result);
/// For programs: docs/formats.md.
[[nodiscard]] nlohmann::ordered_json ObservabilityJson(const Observability& result);

}  // namespace duet
