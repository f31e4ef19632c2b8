// What is promised on real recordings, each through the program: both estimators on EuRoC images in
// motion and at rest, and on a stream that nobody here made. (Calibration:
// recorded_calibration_test.cc.)
// The recordings are no part of the repository; without them these tests say so and are skipped.

#include "test/acceptance/recordings.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

namespace duet {
namespace {

using Json = nlohmann::json;

const char* const kEstimators[] = {"msckf", "window"};

// The comparison of `duet compare --dataset folder`, which must succeed.
Json Compare(const std::string& folder, std::vector<std::string> flags) {
  TemporaryFolder out;
  std::vector<std::string> arguments = {"compare", "--dataset", RealData() / folder,
                                        "--out",   out / "out", "--quiet"};
  arguments.insert(arguments.end(), flags.begin(), flags.end());
  const ProgramResult result = RunDuet(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  return result.status == 0 ? Json::parse(ReadFile(out / "out/comparison.json")) : Json();
}

std::string Text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

// Five starts; `duration` of what follows each.
void ExpectMediansOverStarts(const std::string& cameras, double (*duration)(double),
                             double bound_m) {
  std::map<std::string, std::vector<double>> position_m;
  std::map<std::string, std::vector<double>> orientation_deg;
  std::printf("MH_01_easy_05s, cameras %s, from ground truth: position [m] / orientation [deg]\n",
              cameras.c_str());
  for (const double start : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    const Json comparison =
        Compare("euroc/MH_01_easy_05s", {"--init", "groundtruth", "--cameras", cameras, "--start",
                                         Text(start), "--duration", Text(duration(start))});
    ASSERT_FALSE(comparison.is_null());
    std::printf("  start %.2f s:", start);
    for (const std::string name : kEstimators) {
      const Json& e = comparison[name];
      position_m[name].push_back(e["ate"]["position_m"]);
      orientation_deg[name].push_back(e["ate"]["orientation_deg"]);
      std::printf("  %s %.4f / %.3f (%.2f s)", name.c_str(), position_m[name].back(),
                  orientation_deg[name].back(), e["coverage_s"].get<double>());
      EXPECT_EQ(e["status"], "tracking");
      // Frames come every 0.05 s and starts fall between them.
      EXPECT_GE(e["coverage_s"].get<double>(), 0.99 * (duration(start) - 0.1));
    }
    std::printf("\n");
  }
  for (const std::string name : kEstimators) {
    std::printf("  median %s: %.4f m, %.3f deg\n", name.c_str(), Median(position_m[name]),
                Median(orientation_deg[name]));
    EXPECT_LE(Median(position_m[name]), bound_m);
    EXPECT_LE(Median(orientation_deg[name]), 0.6);
  }
}

TEST(Recordings, RealImagesInMotionMono) {
  SKIP_WITHOUT("euroc/MH_01_easy_05s");
  ExpectMediansOverStarts(
      "0", [](double) { return 14.9; }, 0.010);
}

TEST(Recordings, RealImagesInMotionStereo) {
  SKIP_WITHOUT("euroc/MH_01_easy_05s");
  ExpectMediansOverStarts(
      "0,1", [](double start) { return 7.5 - start; }, 0.012);
}

TEST(Recordings, StartsAndStaysAtRest) {
  SKIP_WITHOUT("euroc/V1_01_easy_00s");
  std::printf("V1_01_easy_00s, started at rest: largest drift from the own first pose [m]\n");
  for (const bool standstill : {true, false}) {
    const Json comparison =
        Compare("euroc/V1_01_easy_00s",
                {"--init", "rest", "--set",
                 std::string("shared.standstill.enabled=") + (standstill ? "true" : "false")});
    ASSERT_FALSE(comparison.is_null());
    std::printf("  %s the standstill measurement:", standstill ? "with" : "without");
    for (const std::string name : kEstimators) {
      const double drift_m = comparison[name]["drift"]["position_max_m"];
      std::printf("  %s %.4f (%.2f s)", name.c_str(), drift_m,
                  comparison[name]["coverage_s"].get<double>());
      if (standstill) {
        EXPECT_LE(drift_m, 0.02);
        EXPECT_GE(comparison[name]["coverage_s"].get<double>(), 2.4);
      }
    }
    std::printf("\n");
  }
}

TEST(Recordings, AStreamThatNobodyHereMade) {
  SKIP_WITHOUT("openvins_sim/V1_01");
  struct Case {
    const char* folder;
    const char* cameras;
    bool bounded;  // V1_01 mono is weakly excited: reported as it is
  };
  std::printf("openvins_sim, from ground truth, no alignment: position [m] / orientation [deg]\n");
  for (const Case& c :
       {Case{"openvins_sim/V1_01", "0,1", true}, Case{"openvins_sim/V1_03", "0", true},
        Case{"openvins_sim/V1_01", "0", false}}) {
    const Json comparison =
        Compare(c.folder, {"--init", "groundtruth", "--cameras", c.cameras, "--alignment", "none"});
    ASSERT_FALSE(comparison.is_null());
    std::printf("  %s cameras %s:", c.folder, c.cameras);
    for (const std::string name : kEstimators) {
      const Json& e = comparison[name];
      const double position_m = e["ate"]["position_m"];
      const double orientation_deg = e["ate"]["orientation_deg"];
      std::printf("  %s %.4f / %.3f, mean NEES of the pose %.2f", name.c_str(), position_m,
                  orientation_deg, e["nees"]["pose"]["mean"].get<double>());
      EXPECT_GE(e["coverage_s"].get<double>(), 39.0);
      if (c.bounded) {
        EXPECT_LT(position_m, 0.05);
        EXPECT_LT(orientation_deg, 0.4);
      }
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace duet
