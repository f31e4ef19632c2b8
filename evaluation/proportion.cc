#include "evaluation/proportion.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "common/support/logging.h"

namespace duet {
namespace {

void CheckProportion(int events, int trials, double confidence) {
  CHECK_GT(trials, 0);
  CHECK(events >= 0 && events <= trials) << events << " of " << trials;
  CHECK(confidence > 0.0 && confidence < 1.0) << confidence;
}

}  // namespace

Band WilsonInterval(int events, int trials, double confidence) {
  CheckProportion(events, trials, confidence);
  const double z = boost::math::quantile(boost::math::normal(), 0.5 + 0.5 * confidence);
  const double n = trials;
  const double p = events / n;
  const double centre = p + z * z / (2.0 * n);
  const double half = z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  const double scale = 1.0 + z * z / n;
  // At no or all events one end is exactly 0 or 1, but for rounding.
  return {events == 0 ? 0.0 : (centre - half) / scale,
          events == trials ? 1.0 : (centre + half) / scale};
}

Band ClopperPearsonInterval(int events, int trials, double confidence) {
  CheckProportion(events, trials, confidence);
  using Binomial = boost::math::binomial;
  const double left_out = 0.5 * (1.0 - confidence);
  return {Binomial::find_lower_bound_on_p(trials, events, left_out),
          Binomial::find_upper_bound_on_p(trials, events, left_out)};
}

double BinomialUpperTail(int events, int trials, double probability) {
  CheckProportion(events, trials, probability);
  if (events == 0) return 1.0;
  const boost::math::binomial chance(trials, probability);
  return boost::math::cdf(boost::math::complement(chance, events - 1));
}

double McNemarPValue(int only_first, int only_second) {
  CHECK(only_first >= 0 && only_second >= 0);
  const int pairs = only_first + only_second;
  if (pairs == 0) return 1.0;
  const boost::math::binomial split(pairs, 0.5);
  return std::min(1.0, 2.0 * boost::math::cdf(split, std::min(only_first, only_second)));
}

}  // namespace duet
