#pragma once

#include <span>
#include <vector>

namespace duet {

/// The Allan deviation of a signal at rest, and the noises that it is made of (IEEE Std 952-1997,
/// annex C; El-Sheimy, Hou and Niu, "Analysis and modeling of inertial sensors using Allan
/// variance", 2008).
///
/// With y_k the mean of the signal over the k-th stretch of length tau = m dt, the Allan variance
/// is half the mean square of neighbouring means' difference. Overlapping: stretches begin at every
/// sample, not only at every m-th. With x the running integral of the signal,
///
///   sigma^2(tau) = sum_k (x_{k+2m} - 2 x_{k+m} + x_k)^2 / (2 tau^2 count).
///
/// In a log-log plot of sigma over tau each noise has a slope of its own:
///
///   white, density N [unit/sqrt(Hz)]           sigma^2 = N^2 / tau              slope -1/2
///   bias instability (flicker), B [unit]       sigma^2 = B^2 2 ln 2 / pi        slope 0
///   bias walk, density K [unit/s/sqrt(Hz)]     sigma^2 = K^2 tau / 3            slope +1/2
///
/// so that N is what the first line has at tau = 1 s, K what the last has at tau = 3 s, and B the
/// flat bottom divided by 0.664.
struct AllanPoint {
  double tau_s = 0.0;
  double deviation = 0.0;  ///< sigma(tau), the signal's unit
  /// Independent differences in it, n / m - 1: sigma^2 is about chi-square distributed with as many
  /// degrees of freedom, so that sigma is known to 1 / sqrt(2 clusters) of itself.
  double clusters = 0.0;
};

/// For stretches from one sample to a ninth of the signal, 12 a decade. Beyond 64 samples a stretch
/// begins at every m / 64-th sample alone, which loses nothing that could be seen. Empty for fewer
/// than 20 samples.
[[nodiscard]] std::vector<AllanPoint> AllanDeviation(std::span<const double> signal,
                                                     double rate_hz);

/// One noise of a fit and its 1 sigma; where the noise is 0, what it could be.
struct NoiseEstimate {
  double value = 0.0;
  double sigma = 0.0;
};

struct AllanFit {
  NoiseEstimate white;        ///< N, unit/sqrt(Hz)
  NoiseEstimate walk;         ///< K, unit/s/sqrt(Hz)
  NoiseEstimate instability;  ///< B, unit
  /// The lowest point of the curve and where it is: min sigma / 0.664 is what data sheets call bias
  /// instability, whichever noises make the bottom.
  double lowest_deviation = 0.0;
  double lowest_tau_s = 0.0;
  /// Root mean square of the curve's departure from the fit in units of what is expected: 1 where
  /// the three noises explain the curve.
  double misfit = 0.0;

  /// sigma(tau) of the three together.
  [[nodiscard]] double Deviation(double tau_s) const;
};

/// The three noises together, over the whole curve, so that none needs a stretch where it rules
/// alone. sigma^2_i is taken as gamma distributed about
///
///   mu_i = N^2 / tau_i + B^2 2 ln 2 / pi + K^2 tau_i / 3,   N^2, B^2, K^2 >= 0,
///
/// with the relative variance 2 / clusters_i + 0.02^2: the second term keeps the shortest
/// stretches, of which there are millions, from ruling where a sensor's own filter bends the curve.
/// Points count by their share of an octave, since neighbours share their data. Solved by Fisher
/// scoring (least squares of sigma^2 / mu, weights from the last round). For fewer than four points
/// or a signal that is constant, all is 0.
[[nodiscard]] AllanFit FitAllan(const std::vector<AllanPoint>& curve);

}  // namespace duet
