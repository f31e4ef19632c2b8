#pragma once

#include "evaluation/chi_squared.h"

namespace duet {

/// Intervals for the probability of an event that was seen `events` times in `trials` (> 0)
/// independent trials: an estimator's failure rate.

/// Wilson's score interval ("Probable inference, the law of succession, and statistical inference",
/// JASA 1927), without continuity correction: its coverage is `confidence` on average, also for few
/// trials and for none or all (Brown, Cai and DasGupta 2001). Tables show this one.
[[nodiscard]] Band WilsonInterval(int events, int trials, double confidence = 0.95);

/// Clopper and Pearson's ("The use of confidence or fiducial limits", Biometrika 1934): its
/// coverage is nowhere below `confidence`, and it is wider therefore.
[[nodiscard]] Band ClopperPearsonInterval(int events, int trials, double confidence = 0.95);

/// The probability that as many events as this or more are seen where each trial has one with
/// `probability` (in (0, 1)): small where chance does not explain them.
[[nodiscard]] double BinomialUpperTail(int events, int trials, double probability);

/// The exact form of McNemar's test (1947): pairs of runs of which the one alone failed, or the
/// other alone. The probability, of both sides, of a split as uneven as this where each is as
/// likely; 1 where there are none.
[[nodiscard]] double McNemarPValue(int only_first, int only_second);

}  // namespace duet
