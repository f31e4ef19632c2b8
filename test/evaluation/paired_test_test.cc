#include "evaluation/paired_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "common/support/random.h"
#include "evaluation/bootstrap.h"
#include "evaluation/holm.h"
#include "evaluation/proportion.h"
#include "evaluation/signed_rank.h"
#include "test/evaluation/reference_values.h"
#include "test/seeds.h"

namespace duet {
namespace {

using test::ReferenceNumber;
using test::ReferenceNumbers;
using test::ReferenceRows;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(SignedRank, AgreesWithR) {
  for (const auto& row : ReferenceRows("signed_rank_r.csv")) {
    const bool exact = row[1] == "1";
    const std::vector<double> differences = ReferenceNumbers(row[5]);
    const SignedRank result = SignedRankTest(
        differences, {.zeros = ZeroDifferences::kWilcoxon, .exact_up_to = exact ? 50 : 0});
    EXPECT_EQ(result.exact, exact) << row[0];
    EXPECT_EQ(result.w_plus, ReferenceNumber(row[2])) << row[0];
    EXPECT_NEAR(result.p_value / ReferenceNumber(row[3]), 1.0, 1e-12) << row[0] << exact;
    if (exact) {
      EXPECT_NEAR(HodgesLehmann(differences), ReferenceNumber(row[4]), 1e-12) << row[0];
    }
  }
}

TEST(SignedRank, AgreesWithScipyAndWithAllSigns) {
  for (const auto& row : ReferenceRows("signed_rank_scipy.csv")) {
    const bool exact = row[1] == "1";
    const ZeroDifferences zeros =
        row[2] == "pratt" ? ZeroDifferences::kPratt : ZeroDifferences::kWilcoxon;
    const SignedRank result =
        SignedRankTest(ReferenceNumbers(row[5]), {.zeros = zeros, .exact_up_to = exact ? 50 : 0});
    EXPECT_EQ(result.w_plus, ReferenceNumber(row[3])) << row[0];
    EXPECT_NEAR(result.p_value / ReferenceNumber(row[4]), 1.0, 1e-12) << row[0] << row[2] << exact;
  }
}

TEST(SignedRank, SmallestValuesAreThoseOfTheTables) {
  // All of n differences to one side: 2^(1 - n).
  EXPECT_EQ(SignedRankTest(std::vector<double>{1, 2, 3, 4, 5}).p_value, 1.0 / 16.0);
  EXPECT_EQ(SignedRankTest(std::vector<double>{1, 2, 3, 4, 5, 6}).p_value, 1.0 / 32.0);
  EXPECT_EQ(SignedRankTest(std::vector<double>{}).p_value, 1.0);
  EXPECT_EQ(SignedRankTest(std::vector<double>{0, 0}).p_value, 1.0);
  EXPECT_EQ(SignedRankTest(std::vector<double>{0, 0}).zeros, 2);
}

TEST(SignedRank, InfiniteDifferencesAreTheLargest) {
  const SignedRank result =
      SignedRankTest(std::vector<double>{kInfinity, 3.0, -1.0, kInfinity, 2.0});
  EXPECT_EQ(result.w_minus, 1.0);
  EXPECT_EQ(result.w_plus, 14.0);
}

TEST(SignedRank, ExactAndNormalMeetWhereTheyChange) {
  Random random(3);
  std::vector<double> differences(50);
  for (double& d : differences) d = random.Normal() + 0.3;
  const double exact = SignedRankTest(differences).p_value;
  const double normal = SignedRankTest(differences, {.exact_up_to = 0}).p_value;
  EXPECT_NEAR(normal / exact, 1.0, 0.05);  // the approximation's error at n = 50
}

TEST(HodgesLehmann, IsTheMedianOfAllMeans) {
  EXPECT_EQ(HodgesLehmann(std::vector<double>{7.0}), 7.0);
  EXPECT_EQ(HodgesLehmann(std::vector<double>{-1.0, 1.0}), 0.0);  // means -1, 0, 1
  EXPECT_EQ(HodgesLehmann(std::vector<double>{-3.0, -1.0, 1.0, 3.0}), 0.0);
  // Means 0 0.5 1 5 5.5 10: the middle two are 1 and 5.
  EXPECT_EQ(HodgesLehmann(std::vector<double>{0.0, 10.0, 1.0}), 3.0);
  Random random(5);
  for (const int n : {2, 3, 10, 31}) {
    std::vector<double> values(static_cast<std::size_t>(n));
    for (double& v : values)
      v = std::exp(3.0 * random.Normal()) * (random.Uniform() < 0.5 ? -1 : 1);
    std::vector<double> means;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j <= i; ++j) means.push_back(0.5 * (values[i] + values[j]));
    }
    std::sort(means.begin(), means.end());
    const double expected = 0.5 * (means[(means.size() - 1) / 2] + means[means.size() / 2]);
    EXPECT_DOUBLE_EQ(HodgesLehmann(values), expected) << n;
  }
}

TEST(Bootstrap, AgreesWithR) {
  for (const auto& row : ReferenceRows("bootstrap_r.csv")) {
    const std::vector<std::vector<double>> values = {ReferenceNumbers(row[6])};
    const Statistic statistic = row[1] == "mean" ? Statistic([](std::span<const double> x) {
      double sum = 0.0;
      for (const double v : x) sum += v;
      return sum / static_cast<double>(x.size());
    })
                                                 : Statistic(HodgesLehmann);
    const Band interval = BootstrapInterval(
        values, statistic, {.resamples = 10000, .confidence = ReferenceNumber(row[2])});
    const double low = ReferenceNumber(row[4]);
    const double high = ReferenceNumber(row[5]);
    // Four standard errors of a 2.5 % quantile of 10000 normal resamples, 0.03 standard
    // deviations each, of about four in the interval; and as much again for tails that are longer.
    const double tolerance = 0.06 * (high - low);
    EXPECT_NEAR(interval.low, low, tolerance) << row[0] << " " << row[1];
    EXPECT_NEAR(interval.high, high, tolerance) << row[0] << " " << row[1];
  }
}

TEST(Bootstrap, IsTheSameEveryTimeAndRefusesTooFew) {
  const std::vector<std::vector<double>> values = {{1, 2, 3, 4}, {2, 4, 8, 16}};
  const Band first = BootstrapInterval(values, HodgesLehmann);
  const Band second = BootstrapInterval(values, HodgesLehmann);
  EXPECT_EQ(first.low, second.low);
  EXPECT_EQ(first.high, second.high);
  const std::vector<std::vector<double>> few = {{1, 2, 3, 4, 5}};
  EXPECT_TRUE(std::isnan(BootstrapInterval(few, HodgesLehmann).low));
  const std::vector<std::vector<double>> equal = {{3, 3, 3, 3, 3, 3}};
  EXPECT_EQ(BootstrapInterval(equal, HodgesLehmann).low, 3.0);
  EXPECT_EQ(BootstrapInterval(equal, HodgesLehmann).high, 3.0);
}

TEST(Proportion, AgreesWithR) {
  for (const auto& row : ReferenceRows("proportions_r.csv")) {
    const int events = static_cast<int>(ReferenceNumber(row[0]));
    const int trials = static_cast<int>(ReferenceNumber(row[1]));
    const double confidence = ReferenceNumber(row[2]);
    const Band wilson = WilsonInterval(events, trials, confidence);
    EXPECT_NEAR(wilson.low, ReferenceNumber(row[3]), 1e-12);
    EXPECT_NEAR(wilson.high, ReferenceNumber(row[4]), 1e-12);
    const Band exact = ClopperPearsonInterval(events, trials, confidence);
    EXPECT_NEAR(exact.low, ReferenceNumber(row[5]), 1e-12);
    EXPECT_NEAR(exact.high, ReferenceNumber(row[6]), 1e-12);
  }
  for (const auto& row : ReferenceRows("mcnemar_r.csv")) {
    const int first = static_cast<int>(ReferenceNumber(row[0]));
    const int second = static_cast<int>(ReferenceNumber(row[1]));
    EXPECT_NEAR(McNemarPValue(first, second), ReferenceNumber(row[2]), 1e-12);
  }
  EXPECT_EQ(McNemarPValue(0, 0), 1.0);
}

TEST(BinomialUpperTail, AgreesWithSumsByHand) {
  EXPECT_EQ(BinomialUpperTail(0, 20, 0.1), 1.0);
  EXPECT_NEAR(BinomialUpperTail(1, 20, 0.1), 1.0 - std::pow(0.9, 20), 1e-14);
  EXPECT_NEAR(BinomialUpperTail(2, 3, 0.25), 3 * 0.0625 * 0.75 + 0.015625, 1e-14);
  EXPECT_NEAR(BinomialUpperTail(20, 20, 0.1), 1e-20, 1e-32);
}

TEST(Holm, AgreesWithR) {
  for (const auto& row : ReferenceRows("holm_r.csv")) {
    const std::vector<double> p = ReferenceNumbers(row[1]);
    const std::vector<double> expected = ReferenceNumbers(row[2]);
    const std::vector<double> adjusted = HolmAdjusted(p);
    const std::vector<bool> rejected = HolmRejections(p, 0.05);
    ASSERT_EQ(adjusted.size(), expected.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      EXPECT_NEAR(adjusted[i], expected[i], 1e-14);
      EXPECT_EQ(rejected[i], adjusted[i] <= 0.05);
    }
  }
  const std::vector<double> with_gap = HolmAdjusted({0.01, std::nan(""), 0.04});
  EXPECT_EQ(with_gap[0], 0.02);
  EXPECT_TRUE(std::isnan(with_gap[1]));
  EXPECT_EQ(with_gap[2], 0.04);
}

/// Errors of one run: log-normal, with a factor exp(scale t) of Student's t with three degrees of
/// freedom, as runs have that nearly diverge.
double HeavyTailedError(double scale, Random* random) {
  const double normal = random->Normal();
  double squares = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double z = random->Normal();
    squares += z * z;
  }
  return 0.1 * std::exp(scale * normal / std::sqrt(squares / 3.0));
}

/// `count` pairs of runs that have nothing in common but their distribution; the second's errors
/// are multiplied by `factor`.
std::vector<PairedRuns> UnrelatedPairs(int count, double scale, double factor, Random* random) {
  std::vector<PairedRuns> pairs;
  for (int i = 0; i < count; ++i) {
    PairedRuns pair;
    pair.first = HeavyTailedError(scale, random);
    pair.second = factor * HeavyTailedError(scale, random);
    pairs.push_back(pair);
  }
  return pairs;
}

/// The share of `repetitions` in which `level` is reached.
double DetectionRate(int repetitions, int pairs, double scale, double factor, double level = 0.05) {
  const Metric metric = MetricOf("ate.position_m");
  PairedOptions options;
  options.bootstrap.resamples = 0;  // only the test is looked at
  Random random(17);
  int detected = 0;
  for (int i = 0; i < repetitions; ++i) {
    const std::vector<PairedRuns> sample = UnrelatedPairs(pairs, scale, factor, &random);
    detected += ComparePairs({&sample, 1}, metric, options).test.p_value <= level ? 1 : 0;
  }
  return static_cast<double>(detected) / repetitions;
}

TEST(PairedTest, HalvesOfOneEstimatorsSeedsGiveFalseAlarmsAtTheNominalRate) {
  // 40 seeds of one estimator, the odd against the even ones. With 20 pairs the exact test's level
  // next below 0.05 is 0.04844 (W = 52 of the published tables); no other rate is right, whatever
  // the distribution.
  const double nominal = 0.04844;
  const int repetitions = test::kSanitized ? 1000 : 4000;
  const double sigma = std::sqrt(nominal * (1.0 - nominal) / repetitions);
  EXPECT_NEAR(DetectionRate(repetitions, 20, 0.1, 1.0), nominal, 4.0 * sigma);
}

TEST(PairedTest, FivePercentAreFoundWithThePowerThatTheNumberOfPairsPromises) {
  // A shift d of logarithms x that differ symmetrically with density f is found by n pairs with
  // probability Phi(sqrt(12 n) d Int f^2 - 1.96) (Pitman's efficacy of the test; Lehmann,
  // Nonparametrics, 1975). Here x is the difference of two t3 of scale s: Int f^2 = 0.1479 / s, by
  // quadrature. With s = 0.07, d = log(1 / 0.95) and 120 pairs that is Phi(4.11 - 1.96) = 0.984,
  // with 60 pairs Phi(2.91 - 1.96) = 0.829, with 20 Phi(1.68 - 1.96) = 0.390.
  const double scale = 0.07;
  const double efficacy = std::sqrt(12.0) * 0.1479 / scale * std::log(1.0 / 0.95);
  const int repetitions = test::kSanitized ? 400 : 1500;
  for (const int pairs : {20, 60, 120}) {
    const double promised =
        0.5 *
        std::erfc(-(efficacy * std::sqrt(static_cast<double>(pairs)) - 1.96) / std::sqrt(2.0));
    const double sigma = std::sqrt(promised * (1.0 - promised) / repetitions);
    // The promise is of the limit of many pairs; 0.03 for what 20 have of it.
    EXPECT_NEAR(DetectionRate(repetitions, pairs, scale, 0.95), promised, 4.0 * sigma + 0.03)
        << pairs;
  }
}

TEST(PairedTest, DetectableDifferenceIsFoundFourTimesInFiveWhateverTheNumberOfTests) {
  const Metric metric = MetricOf("ate.position_m");
  PairedOptions options;
  options.bootstrap.resamples = 200;
  for (const int pairs : {18, 60}) {
    for (const int tests : {1, 8}) {
      const double level = 0.05 / tests;  // Holm's first step
      Random random(23);
      double mean = 0.0;
      const int samples = pairs < 60 ? 60 : 20;
      for (int i = 0; i < samples; ++i) {
        const auto sample = UnrelatedPairs(pairs, 0.07, 1.0, &random);
        mean += std::log(ComparePairs({&sample, 1}, metric, options).Detectable(level)) / samples;
      }
      const int repetitions = test::kSanitized ? 400 : 1500;
      const double rate = DetectionRate(repetitions, pairs, 0.07, std::exp(-mean), level);
      RecordProperty("rate_" + std::to_string(pairs) + "_" + std::to_string(tests),
                     std::to_string(rate));
      // The mean estimate of a standard error is right to 2 %: 0.02 of power; and the limit's 0.03,
      // with few pairs 0.1: tails are heavier than the normal one's. What is detectable at level
      // 0.05 is found at 0.05 / 8 with probability 0.5 only.
      EXPECT_NEAR(rate, 0.8, 4.0 * std::sqrt(0.16 / repetitions) + (pairs < 60 ? 0.1 : 0.05))
          << pairs << " pairs, " << tests << " tests";
    }
  }
}

TEST(PairedTest, FewestPairsThatCanShowGrowWithTheTests) {
  EXPECT_EQ(PairsNeeded(0.05), 6);      // 2^-5 = 0.031
  EXPECT_EQ(PairsNeeded(0.05 / 3), 7);  // 2^-6 = 0.0156, 0.0167 are allowed
  EXPECT_EQ(PairsNeeded(0.05 / 8), 9);  // 2^-8 = 0.0039, 0.0063
  EXPECT_FALSE(CanShow(6, 0.05 / 3));
  EXPECT_TRUE(CanShow(7, 0.05 / 3));
  EXPECT_FALSE(CanShow(0, 0.05));
}

TEST(Bootstrap, IntervalHoldsTheTruthAsOftenAsItSays) {
  Random random(29);
  const int repetitions = test::kSanitized ? 100 : 400;
  int held = 0;
  for (int i = 0; i < repetitions; ++i) {
    std::vector<std::vector<double>> logarithms(1);
    for (const PairedRuns& pair : UnrelatedPairs(20, 0.1, 0.95, &random)) {
      logarithms[0].push_back(std::log(pair.first / pair.second));
    }
    const Band interval = BootstrapInterval(logarithms, HodgesLehmann, {.resamples = 250});
    held += interval.Contains(std::log(1.0 / 0.95)) ? 1 : 0;
  }
  // Of 20 pairs, kept in bounds by measuring: 0.93 to 0.94 of 0.95.
  EXPECT_NEAR(static_cast<double>(held) / repetitions, 0.935,
              4.0 * std::sqrt(0.0475 / repetitions));
}

TEST(PairedTest, FailedRunsAreTheWorstRankAndInNoEffect) {
  std::vector<PairedRuns> pairs;
  for (int i = 0; i < 8; ++i) pairs.push_back({.first = 1.0, .second = 1.1 + 0.01 * i});
  for (int i = 0; i < 3; ++i) {
    pairs.push_back({.first = 1e-6, .second = 1.0, .first_failed = true, .second_failed = false});
  }
  pairs.push_back({.first = 9.0, .second = 9.0, .first_failed = true, .second_failed = true});
  pairs.push_back({.first = std::nan(""), .second = 1.0});
  const PairedComparison result = ComparePairs({&pairs, 1}, MetricOf("ate.position_m"));
  EXPECT_EQ(result.pairs, 8);
  EXPECT_EQ(result.only_first_failed, 3);
  EXPECT_EQ(result.only_second_failed, 0);
  EXPECT_EQ(result.both_failed, 1);
  EXPECT_EQ(result.without_value, 1);
  EXPECT_EQ(result.informative(), 11);
  EXPECT_EQ(result.test.w_plus, 9.0 + 10.0 + 11.0);  // the first is worse
  EXPECT_EQ(result.test.w_minus, 36.0);
  EXPECT_NEAR(result.ratio, 1.0 / 1.135, 0.001);
}

TEST(PairedTest, DirectionFollowsWhatIsBetter) {
  const std::vector<PairedRuns> pairs(8, {.first = -0.5, .second = 0.2});
  const auto direction = [&](const char* metric) {
    return ComparePairs({&pairs, 1}, MetricOf(metric)).direction();
  };
  EXPECT_LT(direction("ate.position_m"), 0.0);         // smaller is better
  EXPECT_GT(direction("coverage_share"), 0.0);         // larger is
  EXPECT_GT(direction("calibration.t_d.error"), 0.0);  // nearer to zero is
  EXPECT_FALSE(ComparePairs({&pairs, 1}, MetricOf("ate.position_m")).is_ratio);
}

}  // namespace
}  // namespace duet
