#include "evaluation/allan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/random.h"
#include "evaluation/allan_report.h"

namespace duet {
namespace {

// By the definition: means of neighbouring stretches, not overlapping.
double PlainAllan(const std::vector<double>& signal, std::size_t m) {
  double squares = 0.0;
  int count = 0;
  const auto mean = [&](std::size_t begin) {
    double sum = 0.0;
    for (std::size_t i = begin; i < begin + m; ++i) sum += signal[i];
    return sum / static_cast<double>(m);
  };
  for (std::size_t k = 0; k + 2 * m <= signal.size(); k += m, ++count) {
    squares += std::pow(mean(k + m) - mean(k), 2);
  }
  return std::sqrt(0.5 * squares / count);
}

std::vector<double> WhiteAndWalk(double white, double walk, double rate_hz, int count,
                                 std::uint64_t seed) {
  Random random(seed);
  std::vector<double> signal;
  double bias = 9.81;
  for (int i = 0; i < count; ++i) {
    signal.push_back(bias + white * std::sqrt(rate_hz) * random.Normal());
    bias += walk / std::sqrt(rate_hz) * random.Normal();
  }
  return signal;
}

TEST(Allan, AgreesWithTheDefinition) {
  // Where stretches do not overlap (m = 1) the two are the same sum.
  const std::vector<double> signal = WhiteAndWalk(0.1, 0.02, 50.0, 4000, 1);
  const std::vector<AllanPoint> curve = AllanDeviation(signal, 50.0);
  EXPECT_NEAR(curve[0].deviation, PlainAllan(signal, 1), 1e-12);
  for (const AllanPoint& point : curve) {
    const auto m = static_cast<std::size_t>(std::lround(50.0 * point.tau_s));
    EXPECT_NEAR(point.clusters, 4000.0 / static_cast<double>(m) - 1.0, 1e-9);
    // Both are known to 1 / sqrt(2 clusters), overlapping better; four of those.
    EXPECT_NEAR(point.deviation / PlainAllan(signal, m), 1.0,
                4.0 / std::sqrt(2.0 * point.clusters) + 0.01);
  }
  // A ramp a t has the mean difference a tau: sigma = a tau / sqrt(2), exactly.
  std::vector<double> ramp;
  for (int i = 0; i < 1000; ++i) ramp.push_back(3.0 + 0.25 * i / 50.0);
  for (const AllanPoint& point : AllanDeviation(ramp, 50.0)) {
    EXPECT_NEAR(point.deviation, 0.25 * point.tau_s / std::sqrt(2.0), 1e-11);
  }
}

// The fit of a curve that is exactly the model gives its numbers back, whichever noise rules.
TEST(Allan, FitGivesAnExactCurvesNumbersBack) {
  struct Case {
    double white, flat, walk;
  };
  for (const Case& c : {Case{2e-4, 3e-5, 2e-5}, Case{2e-3, 0.0, 3e-3}, Case{1.0, 1e-3, 1e-6},
                        Case{0.0, 1e-3, 0.0}, Case{0.0, 0.0, 5.0}}) {
    std::vector<AllanPoint> curve;
    for (double tau_s = 0.005; tau_s < 4000.0; tau_s *= 1.2) {
      AllanFit model;
      model.white.value = c.white;
      model.instability.value = c.flat;
      model.walk.value = c.walk;
      curve.push_back({tau_s, model.Deviation(tau_s), 36000.0 / tau_s});
    }
    const AllanFit fit = FitAllan(curve);
    EXPECT_NEAR(fit.white.value, c.white, 1e-6 * c.white + 1e-9 * (c.flat + c.walk));
    // A noise far below the others is known to its sigma only.
    EXPECT_NEAR(fit.instability.value, c.flat, 1e-6 * c.flat + 0.01 * fit.instability.sigma);
    EXPECT_NEAR(fit.walk.value, c.walk, 1e-6 * c.walk + 0.01 * fit.walk.sigma);
    EXPECT_LT(fit.misfit, 1e-6);
  }
}

TEST(Allan, FitsScatterAsTheySay) {
  constexpr int kRuns = 60;
  double white = 0.0;
  double walk = 0.0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const AllanFit fit = FitAllan(AllanDeviation(WhiteAndWalk(0.1, 0.02, 20.0, 20000, seed), 20.0));
    white += std::pow((fit.white.value - 0.1) / fit.white.sigma, 2) / kRuns;
    walk += std::pow((fit.walk.value - 0.02) / fit.walk.sigma, 2) / kRuns;
    EXPECT_NEAR(fit.walk.value, 0.02, 0.006);
  }
  // In units of the sigma told. It counts octaves as independent and the floor of 2 % as noise, so
  // it is a round number: between half and twice the scatter.
  EXPECT_GT(std::sqrt(white), 0.1);
  EXPECT_LT(std::sqrt(white), 2.0);
  EXPECT_GT(std::sqrt(walk), 0.5);
  EXPECT_LT(std::sqrt(walk), 2.0);
}

TEST(Allan, TooShortOrConstantSignalsGiveNothing) {
  EXPECT_TRUE(AllanDeviation(std::vector<double>(19, 1.0), 10.0).empty());
  const AllanFit fit = FitAllan(AllanDeviation(std::vector<double>(100, 1.0), 10.0));
  EXPECT_EQ(fit.white.value, 0.0);
  EXPECT_EQ(FitAllan({}).walk.value, 0.0);
}

std::vector<ImuSample> RestingImu(int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<ImuSample> imu;
  for (int i = 0; i < count; ++i) {
    imu.push_back({1'000'000'000 + i * Timestamp{5'000'000}, 2e-3 * random.NormalVector<3>(),
                   Eigen::Vector3d(9.81, 0, 0) + 0.03 * random.NormalVector<3>()});
  }
  return imu;
}

TEST(ImuAllan, UsesTheLongestStretchWithoutAGap) {
  std::vector<ImuSample> imu = RestingImu(20000, 4);
  imu.erase(imu.begin() + 5000, imu.begin() + 5003);
  const ImuAllan allan = AnalyzeImu(imu, "imu0/data.csv");
  EXPECT_EQ(allan.samples, 14997);
  EXPECT_EQ(allan.left_out, 5000);
  EXPECT_NEAR(allan.rate_hz, 200.0, 1e-9);
  EXPECT_FALSE(allan.moves);
  EXPECT_NEAR(allan.Noise().gyroscope_density, 2e-3 / std::sqrt(200.0), 5e-6);
  EXPECT_NEAR(allan.Noise().accelerometer_density, 0.03 / std::sqrt(200.0), 7e-5);
  imu.resize(900);
  EXPECT_THROW(static_cast<void>(AnalyzeImu(imu, "imu0/data.csv")), InputError);
  EXPECT_THROW(static_cast<void>(AnalyzeImu({}, "imu0/data.csv")), InputError);
}

TEST(ImuAllan, SaysWhereTheRigMoves) {
  std::vector<ImuSample> imu = RestingImu(4000, 5);
  for (std::size_t i = 0; i < imu.size(); ++i) {
    imu[i].omega_m.z() += 0.3 * std::sin(0.01 * static_cast<double>(i));
  }
  EXPECT_TRUE(AnalyzeImu(imu, "").moves);
}

TEST(ImuAllan, TableHasARowForEachTauAndJsonEachAxis) {
  const ImuAllan allan = AnalyzeImu(RestingImu(4000, 6), "");
  const std::string csv = AllanCsv(allan);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')),
            allan.gyroscope[0].curve.size() + 1);
  const nlohmann::ordered_json json = AllanJson(allan, {.gyroscope_density = 1e-4});
  for (const char* sensor : {"gyroscope", "accelerometer"}) {
    for (const char* axis : {"x", "y", "z"}) {
      EXPECT_GT(json.at(sensor).at(axis).at("white_density").at("value").get<double>(), 0.0);
    }
  }
  EXPECT_EQ(json.at("told").at("gyroscope_noise_density").get<double>(), 1e-4);
}

}  // namespace
}  // namespace duet
