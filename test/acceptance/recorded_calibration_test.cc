// Calibrating on EuRoC's images, each through the program: a calibration told wrong is found, and
// estimating what is told right costs no accuracy. Minutes: part of ./test.sh --all.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "test/acceptance/recordings.h"

namespace duet {
namespace {

using Json = nlohmann::json;

const char* const kBoth[] = {"msckf", "window"};

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
  for (const std::string estimator : kBoth) {
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
    for (const std::string estimator : kBoth) {
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
