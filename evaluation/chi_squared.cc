#include "evaluation/chi_squared.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>

#include "common/support/logging.h"

namespace duet {

double ChiSquaredQuantile(double p, double dof) {
  CHECK(p >= 0.0 && p < 1.0) << p;
  CHECK_GT(dof, 0.0);
  return boost::math::quantile(boost::math::chi_squared(dof), p);
}

Band MeanChiSquaredBand(double dof, int count, double confidence) {
  CHECK_GT(count, 0);
  CHECK(confidence > 0.0 && confidence < 1.0) << confidence;
  // The sum of independent chi-squared variables is one with the sum of their degrees of freedom.
  const double left_out = 0.5 * (1.0 - confidence);
  return {ChiSquaredQuantile(left_out, dof * count) / count,
          ChiSquaredQuantile(1.0 - left_out, dof * count) / count};
}

double MeanChiSquaredPValue(double mean, double dof, int count) {
  CHECK_GT(count, 0);
  if (!(mean >= 0.0)) return 0.0;
  const boost::math::chi_squared distribution(dof * count);
  const double below = boost::math::cdf(distribution, mean * count);
  const double above = boost::math::cdf(boost::math::complement(distribution, mean * count));
  return std::min(1.0, 2.0 * std::min(below, above));
}

}  // namespace duet
