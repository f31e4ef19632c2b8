// The calibration through the program: what a run says of it, duet ablate, and what is refused.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "test/acceptance/program.h"

namespace duet {
namespace {

using testing::HasSubstr;

std::vector<std::string> Ablate(const std::string& out, const std::vector<std::string>& more,
                                const std::string& states = "t_d,p_CB",
                                const std::string& seeds = "1..2") {
  std::vector<std::string> arguments = {"ablate",
                                        "--simulate",
                                        "excited",
                                        "--set",
                                        "simulation.duration_s=3",
                                        "--set",
                                        "simulation.max_tracks=40",
                                        "--states",
                                        states,
                                        "--seeds",
                                        seeds,
                                        "--out",
                                        out,
                                        "--quiet"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(AblateTest, ComparesSubsetsWithTheSameBytesForAnyNumberOfJobs) {
  TemporaryFolder folder;
  const ProgramResult one = RunDuet(Ablate(folder / "one", {"--jobs", "1"}));
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("msckf, estimated: t_d"));
  EXPECT_THAT(one.out, HasSubstr("window, estimated: all"));
  EXPECT_THAT(one.out, HasSubstr("error/predicted"));
  const ProgramResult two = RunDuet(Ablate(folder / "two", {"--jobs", "2"}));
  ASSERT_EQ(two.status, 0) << two.err;
  EXPECT_EQ(ReadFile(folder / "one/calibration.csv"), ReadFile(folder / "two/calibration.csv"));
  EXPECT_EQ(ReadFile(folder / "one/perturbation.yaml"), ReadFile(folder / "two/perturbation.yaml"));
  const auto cells = nlohmann::json::parse(ReadFile(folder / "one/ablation.json"));
  ASSERT_EQ(cells.size(), 8u);  // two estimators; none, t_d, p_CB, all
  // t_d told 10 ms (1 sigma) wrong: fixed it costs accuracy, estimated it is found.
  EXPECT_GT(cells[0]["ate_position_m"]["median"], cells[1]["ate_position_m"]["median"]);
  EXPECT_LT(cells[1]["calibration"]["t_d"]["rms_error"], 0.002);
  // The perturbation that was kept gives the same runs again.
  const ProgramResult again = RunDuet(
      Ablate(folder / "again", {"--jobs", "2", "--perturb", folder / "one/perturbation.yaml"}));
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(ReadFile(folder / "one/calibration.csv"), ReadFile(folder / "again/calibration.csv"));
}

// Shorter than the time before errors count: no error, and not one of 0. The setting is heeded.
TEST(AblateTest, NoDataIsNoErrorOfZero) {
  TemporaryFolder folder;
  const auto ablate = [&](const std::string& out, const std::string& settle_s) {
    return RunDuet(Ablate(folder / out,
                          {"--set", "simulation.duration_s=1", "--set",
                           "evaluation.nees_settle_s=" + settle_s, "--backends", "msckf"},
                          "t_d", "1..1"));
  };
  const ProgramResult none = ablate("none", "2");
  ASSERT_EQ(none.status, 0) << none.err;
  EXPECT_THAT(none.out, HasSubstr("fewer than three of its states come 2 s after the first"));
  EXPECT_THAT(ReadFile(folder / "none/runs.csv"), HasSubstr("msckf,none,1,1,1,21,0,,,,0,"));
  const ProgramResult all = ablate("all", "0");
  ASSERT_EQ(all.status, 0) << all.err;
  for (const auto& cell : nlohmann::json::parse(ReadFile(folder / "all/ablation.json"))) {
    EXPECT_EQ(cell["failed"], 0);
    EXPECT_GT(cell["ate_position_m"]["median"], 0.0);
    EXPECT_GT(cell["pose_nees"]["mean"], 0.0);
  }
}

// The IMU is too slow for shared.max_imu_gap_s: no frame gives a state.
TEST(AblateTest, RunsWithoutAStateAreFailedRunsAndNoCrash) {
  TemporaryFolder folder;
  const ProgramResult simulated =
      RunDuet(Ablate(folder / "simulated", {"--set", "simulation.imu_rate_hz=15"}, "t_d", "1..1"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_THAT(simulated.out,
              HasSubstr("failed: msckf, t_d, seed 1 after 0.0 s: the IMU has a gap"));
  const auto cells = nlohmann::json::parse(ReadFile(folder / "simulated/ablation.json"));
  for (const auto& cell : cells) {
    EXPECT_EQ(cell["failed"], 1);
    EXPECT_TRUE(cell["ate_position_m"]["median"].is_null());
    EXPECT_TRUE(cell["outside_3_prior_sigmas"].is_null());
    EXPECT_GT(cell["dead_reckoned"]["frames"], 0);
  }
  const ProgramResult made =
      RunDuet({"simulate", "--preset", "excited", "--set", "duration_s=3", "--set", "max_tracks=40",
               "--out", folder / "data", "--quiet"});
  ASSERT_EQ(made.status, 0) << made.err;
  const ProgramResult recorded = RunDuet(
      {"ablate", "--dataset", folder / "data", "--init", "groundtruth", "--states", "t_d",
       "--seeds", "1..1", "--set", "shared.max_imu_gap_s=0.001", "--out", folder / "recorded"});
  ASSERT_EQ(recorded.status, 0) << recorded.err;
  EXPECT_THAT(recorded.out, HasSubstr("failed: window, t_d, seed 1 after 0.0 s: "));
  EXPECT_THAT(recorded.out, testing::Not(HasSubstr("NEES")));
  const ProgramResult settled =
      RunDuet({"ablate", "--dataset", folder / "data", "--states", "t_d", "--seeds", "1..1",
               "--set", "evaluation.nees_settle_s=1", "--out", folder / "settled"});
  EXPECT_EQ(settled.status, 2);
  EXPECT_THAT(settled.err, HasSubstr("evaluation.nees_settle_s: has no effect in duet ablate "
                                     "--dataset, which claims no NEES"));
}

// evaluation.* is heeded: on a recording the errors of the same runs are duet compare's own.
TEST(AblateTest, ErrorsAreTakenAsTheConfigurationSaysAndTheTableSaysHow) {
  TemporaryFolder folder;
  const ProgramResult made =
      RunDuet({"simulate", "--preset", "excited", "--set", "duration_s=3", "--set", "max_tracks=40",
               "--out", folder / "data", "--quiet"});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::vector<std::string> shared = {"--dataset",
                                           folder / "data",
                                           "--init",
                                           "groundtruth",
                                           "--quiet",
                                           "--set",
                                           "evaluation.association=evo",
                                           "--set",
                                           "evaluation.alignment=se3"};
  std::vector<std::string> ablate = {"ablate",  "--states", "t_d",   "--perturb",        "none",
                                     "--seeds", "1..1",     "--out", folder / "ablation"};
  ablate.insert(ablate.end(), shared.begin(), shared.end());
  std::vector<std::string> compare = {"compare", "--out", folder / "compare"};
  compare.insert(compare.end(), shared.begin(), shared.end());
  const ProgramResult ablated = RunDuet(ablate);
  ASSERT_EQ(ablated.status, 0) << ablated.err;
  EXPECT_THAT(ablated.out, HasSubstr("\nErrors after alignment se3, positions and orientations "
                                     "apart; pairs of \"evo\" (nearest in time)"));
  const ProgramResult compared = RunDuet(compare);
  ASSERT_EQ(compared.status, 0) << compared.err;
  const auto comparison = nlohmann::json::parse(ReadFile(folder / "compare/comparison.json"));
  int untouched = 0;  // cells that estimate nothing, as duet compare by default
  for (const auto& cell : nlohmann::json::parse(ReadFile(folder / "ablation/ablation.json"))) {
    EXPECT_EQ(cell["alignment"], "se3");
    if (cell["variant"] != "none") continue;
    const auto& ate = comparison[cell["estimator"].get<std::string>()]["ate"];
    // The poses are the same, but for how their files are read back.
    EXPECT_NEAR(cell["ate_position_m"]["median"], ate["position_m"], 1e-9);
    EXPECT_NEAR(cell["ate_orientation_deg"]["median"], ate["orientation_deg"], 1e-9);
    ++untouched;
  }
  EXPECT_EQ(untouched, 2);
  // Of a simulation the first state's error is in the errors where nothing is aligned.
  const auto position_m = [&](const std::string& alignment) {
    const ProgramResult result = RunDuet(Ablate(
        folder / alignment, {"--set", "evaluation.alignment=" + alignment, "--backends", "msckf"},
        "t_d", "1..1"));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("\nErrors after alignment " + alignment + ", positions"));
    const auto cells = nlohmann::json::parse(ReadFile(folder / alignment + "/ablation.json"));
    return cells[1]["ate_position_m"]["median"].get<double>();
  };
  EXPECT_GT(position_m("none"), position_m("posyaw"));
}

TEST(AblateTest, BadInputIsOneClearLine) {
  TemporaryFolder folder;
  const std::string out = folder / "out";
  WriteFile(folder / "focal.yaml", "told_offset: {intrinsics_px: [-500, 0, 0, 0]}\n");
  const std::vector<std::pair<std::vector<std::string>, std::string>> refused = {
      {Ablate(out, {}, "t_dd"), "unknown name 't_dd'; did you mean 't_d'?"},
      {Ablate(out, {}, "t_d,t_d"), "'t_d' stands there twice"},
      {Ablate(out, {}, "t_d", "2..1"), "expected A..B with 0 <= A <= B"},
      {Ablate(out, {"--set", "shared.calibration.imu_frame=camera"}, "all"),
       "shared.calibration.imu_frame: estimating all: camera ties"},
      {Ablate(out, {"--perturb", folder / "none.yaml"}), "none.yaml"},
      {Ablate(out, {"--set", "shared.calibration.told_offset.t_d_s=[0.01]"}),
       "told_offset: have no effect in duet ablate; expected --perturb FILE"},
      {Ablate(out, {"--set", "shared.calibration.cameras=[1]"}),
       "shared.calibration.cameras: names camera 1; expected cameras of the rig"},
      {Ablate(out, {"--perturb", folder / "focal.yaml"}),
       "told_offset.intrinsics_px: the told fx of camera 0 is -41"},
      {Ablate(out, {"--set", "evaluation.association=evo"}),
       "evaluation.association: has no effect in duet ablate --simulate, where the truth is known "
       "at every instant; expected the default, interpolated"},
      {Ablate(out, {"--set", "evaluation.max_truth_gap_s=0.1"}),
       "evaluation.max_truth_gap_s: has no effect in duet ablate --simulate"},
      {Ablate(out, {"--set", "evaluation.relative_lengths_m=[1]"}),
       "evaluation.relative_lengths_m: has no effect in duet ablate, which takes no relative"},
      {Ablate(out, {"--jobs", "0"}), "--jobs: is 0; expected at least 1"},
      {Ablate(out, {"--duration", "3"}), "--duration: has no effect beside --simulate"},
      {Ablate(out, {"--dataset", folder / "x"}), "expected either --dataset or --simulate"}};
  for (const auto& [arguments, says] : refused) {
    const ProgramResult result = RunDuet(arguments);
    EXPECT_EQ(result.status, 2) << says;
    EXPECT_THAT(result.err, HasSubstr(says));
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

TEST(CalibratingRun, SaysWhatItFoundAndRefusesContradictions) {
  TemporaryFolder folder;
  const ProgramResult simulated =
      RunDuet({"simulate", "--preset", "excited", "--set", "duration_s=4", "--set", "max_tracks=40",
               "--set", "t_d_s=0.004", "--out", folder / "data", "--quiet"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto run = [&](const std::string& out, std::vector<std::string> settings) {
    std::vector<std::string> arguments = {"run",         "--dataset", folder / "data",
                                          "--backend",   "msckf",     "--init",
                                          "groundtruth", "--out",     folder / out};
    for (const std::string& setting : settings) {
      arguments.insert(arguments.end(), {"--set", "shared.calibration." + setting});
    }
    return RunDuet(arguments);
  };
  const ProgramResult found = run("found", {"t_d.state=estimated", "told_offset.t_d_s=[0.01]"});
  ASSERT_EQ(found.status, 0) << found.err;
  EXPECT_THAT(found.out, HasSubstr("observed"));
  EXPECT_THAT(ReadFile(folder / "found/calibration.csv"), HasSubstr("t_d"));

  // A prior of 1 ms and an error of 10 ms: the estimate must leave the prior, and that is said.
  const ProgramResult left =
      run("left", {"t_d.state=estimated", "t_d.sigma=0.001", "told_offset.t_d_s=[0.01]"});
  ASSERT_EQ(left.status, 0) << left.err;
  EXPECT_THAT(left.out, HasSubstr("LEFT ITS PRIOR"));
  EXPECT_THAT(ReadFile(folder / "left/manifest.json"), HasSubstr("t_d left its prior"));

  const ProgramResult gauge = run("gauge", {"imu_frame=camera", "T_g.state=estimated",
                                            "T_a.state=estimated", "R_CB.state=estimated"});
  EXPECT_EQ(gauge.status, 2);
  EXPECT_THAT(gauge.err, HasSubstr("shared.calibration.imu_frame: camera ties the body's axes"));
  const ProgramResult bounds = run("bounds", {"t_r.state=estimated", "told_offset.t_r_s=[0.06]"});
  EXPECT_EQ(bounds.status, 2);
  EXPECT_THAT(bounds.err, HasSubstr("shared.max_abs_t_r_s: is 0.05; expected at least the told"));
  const ProgramResult numbers = run("numbers", {"told_offset.p_CB_m=[0.01]"});
  EXPECT_EQ(numbers.status, 2);
  EXPECT_THAT(numbers.err, HasSubstr("told_offset.p_CB_m: has 1 numbers; expected 3"));

  // No estimator can do anything with these, whatever it is asked for.
  WriteFile(folder / "study.yaml",
            "study: bad\nstreams: [{name: sim, simulate: excited, "
            "set: {simulation.duration_s: 1}}]\n"
            "set: {shared.calibration.cameras: [1]}\nestimators: [msckf]\nseeds: 1..1\n");
  const ProgramResult study =
      RunDuet({"study", folder / "study.yaml", "--quiet", "--out", folder / "study"});
  EXPECT_EQ(study.status, 2);
  EXPECT_THAT(study.err, HasSubstr("shared.calibration.cameras: names camera 1; expected"));
  const std::vector<std::pair<std::string, std::string>> impossible = {
      {"cameras=[1]", "shared.calibration.cameras: names camera 1; expected"},
      {"told_offset.intrinsics_px=[-500,0,0,0]", "told_offset.intrinsics_px: the told fx"},
      {"told_offset.T_g=[-1,0,0,0,0,0,0,0,0]", "told_offset.T_g: the told T_g has a determinant"}};
  for (const auto& [setting, says] : impossible) {
    const ProgramResult ran = run("impossible", {setting});
    const ProgramResult observed =
        RunDuet({"observability", "--quiet", "--dataset", folder / "data", "--set",
                 "shared.calibration." + setting});
    for (const ProgramResult& result : {ran, observed}) {
      EXPECT_EQ(result.status, 2) << setting;
      EXPECT_THAT(result.err, HasSubstr(says));
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "impossible"));
  }
}

}  // namespace
}  // namespace duet
