#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "test/acceptance/program.h"

namespace duet {
namespace {

// From the truth, from a run and from a trajectory; the same bytes twice; what the configuration
// estimates and nothing else; refusals that say what is missing.
TEST(Observability, SaysWhatARecordingCanCalibrate) {
  TemporaryFolder folder;
  const std::string recording = folder / "straight";
  const ProgramResult simulated = RunDuet(
      {"simulate", "--set", "trajectory=straight_line", "--set", "world=box", "--set",
       "duration_s=8", "--set", "max_tracks=40", "--set", "t_r_s=0.02", "--out", recording});
  ASSERT_EQ(simulated.status, 0) << simulated.err;

  const ProgramResult result = RunDuet(
      {"observability", "--quiet", "--dataset", recording, "--out", folder / "everything.json"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("everything estimated"), std::string::npos);
  EXPECT_NE(result.out.find("\ncannot: "), std::string::npos);
  const std::string text = ReadFile(folder / "everything.json");
  const auto json = nlohmann::json::parse(text);
  EXPECT_EQ(json.at("frames").get<int>(), 161);
  EXPECT_EQ(json.at("components").size(), 41U);
  EXPECT_EQ(json.at("cut").at("covariance").size(), 41U);
  EXPECT_EQ(json.at("whole").at("history").size(), 2U);  // 5 s and the end
  for (const auto& component : json.at("components")) {
    const std::string name = component.at("name");
    const double whole = component.at("sigma_whole");
    const double cut = component.at("sigma_cut");
    EXPECT_LE(whole, cut * (1.0 + 1e-9)) << name;
    EXPECT_LE(cut, component.at("prior_sigma").get<double>() * (1.0 + 1e-9)) << name;
    if (name == "t_d" || name == "cam0.p_CB.x" || name == "cam0.fx" || name == "T_a.11") {
      EXPECT_EQ(component.at("verdict"), "unobservable") << name;
    }
    if (name == "cam0.k3") {
      EXPECT_EQ(component.at("verdict"), "observed");
    }
  }

  const ProgramResult again =
      RunDuet({"observability", "--quiet", "--dataset", recording, "--out", folder / "again.json"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_EQ(ReadFile(folder / "again.json"), text);
  EXPECT_EQ(again.out, result.out);
  const ProgramResult refused =
      RunDuet({"observability", "--quiet", "--dataset", recording, "--out", folder / "again.json"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("exists"), std::string::npos) << refused.err;

  const ProgramResult nowhere =
      RunDuet({"observability", "--quiet", "--dataset", recording, "--out", folder / "no/x.json"});
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_NE(nowhere.err.find("lies in no folder"), std::string::npos) << nowhere.err;
  EXPECT_TRUE(nowhere.out.empty()) << nowhere.out;  // before the work

  const std::vector<std::string> t_d_and_t_r = {"--set", "shared.calibration.t_d.state=estimated",
                                                "--set", "shared.calibration.t_r.state=estimated"};
  const auto with = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), t_d_and_t_r.begin(), t_d_and_t_r.end());
    return RunDuet(arguments);
  };
  const ProgramResult run = with({"run", "--quiet", "--dataset", recording, "--backend", "msckf",
                                  "--init", "groundtruth", "--out", folder / "run"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string truth = recording + "/mav0/state_groundtruth_estimate0/data.csv";
  WriteFile(truth, ReadFile(truth).substr(0, ReadFile(truth).find('\n', 60'000) + 1));
  const ProgramResult brief = with({"observability", "--quiet", "--dataset", recording});
  EXPECT_EQ(brief.status, 2);
  EXPECT_NE(brief.err.find("expected at least 5 s"), std::string::npos) << brief.err;
  std::filesystem::remove_all(std::filesystem::path(recording) / "mav0" /
                              "state_groundtruth_estimate0");
  const ProgramResult no_truth = with({"observability", "--quiet", "--dataset", recording});
  EXPECT_EQ(no_truth.status, 2);
  EXPECT_NE(no_truth.err.find("has no ground truth"), std::string::npos) << no_truth.err;
  EXPECT_NE(no_truth.err.find("--estimate"), std::string::npos) << no_truth.err;
  for (const std::string estimate : {"run", "run/trajectory.tum"}) {
    SCOPED_TRACE(estimate);
    const std::string out = folder / (estimate.size() > 3 ? "of_file.json" : "of_run.json");
    const ProgramResult estimated = with({"observability", "--quiet", "--dataset", recording,
                                          "--estimate", folder / estimate, "--out", out});
    ASSERT_EQ(estimated.status, 0) << estimated.err;
    EXPECT_NE(estimated.out.find("states of the estimate, estimated as configured"),
              std::string::npos);
    const auto times = nlohmann::json::parse(ReadFile(out)).at("components");
    ASSERT_EQ(times.size(), 2U);
    EXPECT_EQ(times[0].at("name"), "t_d");
    EXPECT_EQ(times[1].at("name"), "t_r");
    EXPECT_LT(times[1].at("sigma_whole").get<double>(), 0.02);
  }
  const ProgramResult absent = with(
      {"observability", "--quiet", "--dataset", recording, "--estimate", folder / "nothing.tum"});
  EXPECT_EQ(absent.status, 2);
  EXPECT_NE(absent.err.find("nothing.tum"), std::string::npos) << absent.err;
}

}  // namespace
}  // namespace duet
