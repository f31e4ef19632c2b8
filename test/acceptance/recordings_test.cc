// What is promised on real recordings, each through the program: both estimators on EuRoC images in
// motion and at rest, on a stream that nobody here made, and calibrating on EuRoC images.
// The recordings are no part of the repository; without them these tests say so and are skipped.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "test/acceptance/program.h"

namespace duet {
namespace {

using Json = nlohmann::json;

const char* const kEstimators[] = {"msckf", "window"};

#define SKIP_WITHOUT(folder)                                                        \
  if (RealData().empty() || !std::filesystem::exists(RealData() / (folder))) {      \
    GTEST_SKIP() << "SKIPPED: no recording " << (folder)                            \
                 << " on this machine (set DUET_DATA to the folder of recordings)"; \
  }

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

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
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

// calibration.csv of `duet run` over recorded tracks: the estimates at the end by name.
std::map<std::string, double> Calibrated(const std::string& tracks, const std::string& estimator,
                                         std::vector<std::string> settings) {
  TemporaryFolder out;
  std::vector<std::string> arguments = {
      "run",      "--dataset", RealData() / "euroc/MH_01_easy_05s",
      "--tracks", tracks,      "--backend",
      estimator,  "--init",    "groundtruth",
      "--out",    out / "out", "--quiet"};
  for (const std::string& setting : settings) {
    arguments.insert(arguments.end(), {"--set", "shared.calibration." + setting});
  }
  const ProgramResult result = RunDuet(arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  std::map<std::string, double> estimates;
  std::istringstream rows(ReadFile(out / "out/calibration.csv"));
  for (std::string row; std::getline(rows, row);) {
    if (row.starts_with('#')) continue;
    std::istringstream fields(row);
    std::string told;
    std::string estimate;
    std::getline(fields, told, ',');
    std::getline(fields, estimate, ',');
    estimates[row.substr(row.rfind(',') + 1)] = std::stod(estimate);
  }
  return estimates;
}

// Cameras, extrinsics and t_d are estimated together; each of three is then told wrong.
TEST(Recordings, AWrongCalibrationIsFoundOnRealImages) {
  SKIP_WITHOUT("euroc/MH_01_easy_05s");
  TemporaryFolder folder;
  const std::string tracks = folder / "tracks";
  const ProgramResult tracked = RunDuet(
      {"track", "--dataset", RealData() / "euroc/MH_01_easy_05s", "--out", tracks, "--quiet"});
  ASSERT_EQ(tracked.status, 0) << tracked.err;
  const std::vector<std::string> estimated = {
      "p_CB.state=estimated",       "p_CB.sigma=0.03",       "R_CB.state=estimated",
      "intrinsics.state=estimated", "intrinsics.sigma=14",   "distortion.state=estimated",
      "distortion.sigma=0.001",     "distortion.share=0.05", "t_d.state=estimated"};
  const auto with = [&](const std::string& offset) {
    std::vector<std::string> settings = estimated;
    settings.push_back("told_offset." + offset);
    return settings;
  };
  std::printf("MH_01_easy_05s, told wrong: what is left of it at the end\n");
  for (const std::string estimator : kEstimators) {
    const auto right = Calibrated(tracks, estimator, estimated);
    ASSERT_TRUE(right.contains("t_d"));
    auto wrong = Calibrated(tracks, estimator, with("t_d_s=[0.01]"));
    const double t_d_ms = 1e3 * std::abs(wrong["t_d"] - right.at("t_d"));
    EXPECT_LT(t_d_ms, 0.3);
    std::printf("  %s: t_d 10 ms: %.4f ms", estimator.c_str(), t_d_ms);
    for (const char* offset :
         {"p_CB_m=[0.03, 0, 0]", "p_CB_m=[0, 0.03, 0]", "p_CB_m=[0, 0, 0.03]"}) {
      wrong = Calibrated(tracks, estimator, with(offset));
      double square_mm2 = 0.0;
      for (const char* axis : {"cam0.p_CB.x", "cam0.p_CB.y", "cam0.p_CB.z"}) {
        square_mm2 += std::pow(1e3 * (wrong[axis] - right.at(axis)), 2);
      }
      EXPECT_LT(std::sqrt(square_mm2), 6.0);
      std::printf("; %s: %.3f mm", offset, std::sqrt(square_mm2));
    }
    wrong = Calibrated(tracks, estimator, with("intrinsics_px=[13.8, 13.7, 0, 0]"));  // 3 %
    for (const char* focal : {"cam0.fx", "cam0.fy"}) {
      const double share = std::abs(wrong[focal] / right.at(focal) - 1.0);
      EXPECT_LT(share, 0.01);
      std::printf("; %s 3 %%: %.4f %%", focal, 100.0 * share);
    }
    std::printf("\n");
  }
}

TEST(Recordings, EstimatingEverythingCostsLittleAccuracy) {
  SKIP_WITHOUT("euroc/MH_01_easy_05s");
  std::printf("MH_01_easy_05s, EuRoC's calibration told: position [m], median of five starts\n");
  for (const std::string states :
       {"p_CB,R_CB,intrinsics,distortion,t_d", "T_g,T_s,T_a,p_CB,R_CB,intrinsics,distortion,t_d"}) {
    std::map<std::string, std::map<std::string, std::vector<double>>> position_m;
    for (const char* start : {"0", "0.25", "0.5", "0.75", "1"}) {
      TemporaryFolder out;
      const ProgramResult result =
          RunDuet({"ablate", "--dataset", RealData() / "euroc/MH_01_easy_05s", "--init",
                   "groundtruth", "--start", start, "--states", states, "--design", "none_and_all",
                   "--perturb", "none", "--seeds", "1..1", "--out", out / "out", "--quiet"});
      ASSERT_EQ(result.status, 0) << result.err;
      for (const Json& cell : Json::parse(ReadFile(out / "out/ablation.json"))) {
        EXPECT_EQ(cell["failed"], 0);
        position_m[cell["estimator"]][cell["variant"]].push_back(cell["ate_position_m"]["median"]);
      }
    }
    std::printf("  %s:", states.c_str());
    for (const std::string estimator : kEstimators) {
      const double fixed_m = Median(position_m[estimator]["none"]);
      const double estimated_m = Median(position_m[estimator]["all"]);
      EXPECT_LE(estimated_m, 1.25 * fixed_m);
      std::printf("  %s fixed %.4f, estimated %.4f", estimator.c_str(), fixed_m, estimated_m);
    }
    std::printf("\n");
  }
}

}  // namespace
}  // namespace duet
