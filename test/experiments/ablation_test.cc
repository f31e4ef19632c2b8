// Which subsets of the calibration an ablation runs, in what order results come, and what counts of
// a run.

#include "experiments/ablation/ablation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "backends/factory.h"
#include "experiments/ablation/ablation_report.h"

namespace duet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> Names(const std::vector<AblationVariant>& variants) {
  std::vector<std::string> names;
  for (const AblationVariant& variant : variants) names.push_back(variant.name);
  return names;
}

TEST(Ablation, DesignsNameTheirSubsets) {
  const std::vector<std::string> blocks = {"T_g", "p_CB", "t_d"};
  EXPECT_THAT(Names(AblationVariants(blocks, AblationDesign::kOneAtATime)),
              ElementsAre("none", "T_g", "p_CB", "t_d", "all"));
  EXPECT_THAT(Names(AblationVariants(blocks, AblationDesign::kCombinations)),
              ElementsAre("none", "T_g", "p_CB", "t_d", "T_g p_CB", "T_g t_d", "p_CB t_d", "all"));
  EXPECT_THAT(Names(AblationVariants(blocks, AblationDesign::kNoneAndAll)),
              ElementsAre("none", "all"));
  EXPECT_THAT(Names(AblationVariants({"t_d"}, AblationDesign::kOneAtATime)),
              ElementsAre("none", "t_d"));
}

TEST(Ablation, AVariantEstimatesItsBlocksAndNoOthers) {
  CalibrationPriors priors;
  priors.t_r.estimated = true;  // not listed: fixed
  priors.p_CB.sigma = 0.07;
  const CalibrationPriors chosen = PriorsOf({.name = "p_CB", .estimated = {"p_CB"}}, priors);
  EXPECT_TRUE(chosen.p_CB.estimated);
  EXPECT_EQ(chosen.p_CB.sigma, 0.07);
  EXPECT_FALSE(chosen.t_r.estimated);
  const ToldErrors errors = PriorErrorsOf({"p_CB"}, priors);
  EXPECT_EQ(errors.p_CB_m, 0.07);
  EXPECT_EQ(errors.t_d_s, 0.0);
}

TEST(Ablation, ResultsStandInOrderForAnyNumberOfThreads) {
  AblationPlan plan;
  plan.estimators = {"a", "b"};
  plan.variants = AblationVariants({"t_d"}, AblationDesign::kNoneAndAll);
  plan.first_seed = 3;
  plan.last_seed = 7;
  plan.threads = 4;
  const std::vector<AblationCell> cells = RunAblation(
      plan,
      [](const std::string& estimator, const CalibrationPriors& priors, int seed) {
        MonteCarloRun run;
        run.seed = seed;
        run.reason = estimator + (priors.t_d.estimated ? "+" : "-");
        return run;
      },
      [](int) { return true; });
  ASSERT_EQ(cells.size(), 4u);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    ASSERT_EQ(cells[c].runs.size(), 5u);
    for (int i = 0; i < 5; ++i) {
      EXPECT_EQ(cells[c].runs[static_cast<std::size_t>(i)].seed, 3 + i);
      EXPECT_EQ(cells[c].runs[static_cast<std::size_t>(i)].reason,
                std::string(c < 2 ? "a" : "b") + (c % 2 == 0 ? "-" : "+"));
    }
  }
}

TEST(Ablation, StopsWhereItIsInterrupted) {
  AblationPlan plan;
  plan.estimators = {"a"};
  plan.variants = AblationVariants({"t_d"}, AblationDesign::kNoneAndAll);
  plan.first_seed = 1;
  plan.last_seed = 50;
  std::atomic<int> runs{0};
  const std::vector<AblationCell> cells = RunAblation(
      plan,
      [&](const std::string&, const CalibrationPriors&, int) {
        ++runs;
        return MonteCarloRun();
      },
      [](int done) { return done < 3; });
  EXPECT_TRUE(cells.empty());
  EXPECT_EQ(runs, 3);
}

// One run of t_d alone that was told 0, ends after `frames` frames and reports `t_d_s` all the
// time.
MonteCarloRun RunOfTimeOffset(double t_d_s, int frames, bool failed) {
  CalibrationPriors priors;
  priors.t_d.estimated = true;
  priors.t_d.sigma = 0.01;
  MonteCarloRun run;
  run.calibration = CalibrationErrors(CalibrationLayout(priors, {}), {});
  RigCalibration estimate;
  estimate.t_d_s = t_d_s;
  for (int i = 0; i < frames; ++i) {
    run.calibration.Add(i, estimate, Eigen::Matrix<double, 1, 1>::Constant(1e-6));
  }
  run.frames = frames;
  run.dead_reckoned = 1;
  run.failed = failed;
  run.ate_position_m = run.ate_orientation_deg = failed ? std::nan("") : 0.1;
  return run;
}

AblationClaims Claims(bool consistency) {
  return {.consistency = consistency,
          .predicted_sigma = [](const AblationCell&) { return Eigen::VectorXd(); }};
}

// A run that leaves its prior, then fails, is no run that stayed within it.
TEST(AblationReport, CountsFailedRunsWhereTheyLeftTheirPrior) {
  const AblationCell cell{
      .estimator = "msckf",
      .variant = {.name = "t_d", .estimated = {"t_d"}},
      .runs = {RunOfTimeOffset(0.001, 9, false), RunOfTimeOffset(0.05, 3, true)}};
  const AblationClaims claims{
      .predicted_sigma = [](const AblationCell&) { return Eigen::VectorXd(); }};
  const auto json = AblationJson({cell}, claims).front();
  EXPECT_EQ(json["failed"], 1);
  EXPECT_NEAR(json["outside_3_prior_sigmas"], 3.0 / 12.0, 1e-12);
  EXPECT_EQ(json["outside_3_prior_sigmas_at_end"]["count"], 1);
  EXPECT_EQ(json["dead_reckoned"]["frames"], 2);
  EXPECT_EQ(json["dead_reckoned"]["of"], 12);
  EXPECT_NEAR(json["ate_position_m"]["max"], 0.1, 1e-12);
  EXPECT_THAT(AblationText({cell}, claims), HasSubstr(" 2 of 12 "));
  EXPECT_THAT(AblationRunsCsv({cell}, claims), HasSubstr("\nmsckf,t_d,0,1,0,3,1,,,"));
}

// The foot says what the errors above it are.
TEST(AblationReport, SaysHowErrorsWereTaken) {
  const std::vector<AblationCell> cells = {{.estimator = "msckf",
                                            .variant = {.name = "t_d", .estimated = {"t_d"}},
                                            .runs = {RunOfTimeOffset(0.001, 9, false)}}};
  AblationClaims claims = Claims(false);
  EXPECT_THAT(AblationText(cells, claims),
              HasSubstr("\nErrors after alignment posyaw, positions and orientations apart; truth "
                        "interpolated over at most 0.06 s; all states.\n"));
  EXPECT_EQ(AblationJson(cells, claims).front()["alignment"], "posyaw");
  claims.evaluation.alignment = AlignmentMode::kSe3;
  claims.evaluation.association = AssociationMode::kRpgNearest;
  EXPECT_THAT(AblationText(cells, claims),
              HasSubstr("alignment se3, positions and orientations apart; pairs of \"rpg\""));
  claims.consistency = true;
  claims.evaluation.nees_settle_s = 3.0;
  EXPECT_THAT(AblationText(cells, claims), HasSubstr("states from 3 s after the first on."));
  EXPECT_EQ(AblationJson(cells, claims).front()["alignment"], "se3");
}

// A recording's own calibration is no truth: what is said of it claims no consistency.
TEST(AblationReport, ClaimsNoConsistencyOfARecording) {
  const std::vector<AblationCell> cells = {{.estimator = "msckf",
                                            .variant = {.name = "t_d", .estimated = {"t_d"}},
                                            .runs = {RunOfTimeOffset(0.05, 9, false)}}};
  for (const char* word : {"NEES", "onsistent", "INCONSISTENT", "band"}) {
    EXPECT_THAT(AblationText(cells, Claims(false)), Not(HasSubstr(word)));
  }
  EXPECT_THAT(AblationText(cells, Claims(false)), HasSubstr("against the recording's own"));
  EXPECT_THAT(AblationText(cells, Claims(true)), HasSubstr("INCONSISTENT"));
  const auto recorded = AblationJson(cells, Claims(false)).front();
  for (const char* key : {"nees", "band", "p_value", "rejected", "true", "rms_error"}) {
    EXPECT_THAT(recorded.dump(), Not(HasSubstr(key)));
  }
  EXPECT_NEAR(recorded["against_own_calibration"]["t_d"]["rms_difference"], 0.05, 1e-12);
  const auto simulated = AblationJson(cells, Claims(true)).front();
  EXPECT_NEAR(simulated["calibration"]["t_d"]["mean_nees"], 2500.0, 1e-6);
  EXPECT_THAT(AblationRunsCsv(cells, Claims(false)), HasSubstr(",0.1,0.1,,1,"));
  EXPECT_THAT(AblationRunsCsv(cells, Claims(true)), Not(HasSubstr(",0.1,0.1,,1,")));
}

// A gap between IMU samples that is longer than shared.max_imu_gap_s, everywhere: no frame is used.
TEST(RunOnce, FailsWithAReasonWhereNoFrameGivesAState) {
  MonteCarloOptions options;
  options.simulation = SimulationPreset("excited");
  options.simulation.duration_s = 0.5;  // before the estimators give up themselves
  options.simulation.imu_rate_hz = 15.0;
  options.shared.calibration.t_d.estimated = true;
  for (const std::string& name : EstimatorNames()) {
    const MonteCarloRun run = RunOnce(
        options, 1, [&](const EstimatorSetup& setup) { return MakeEstimator(name, setup, {}); });
    EXPECT_TRUE(run.failed) << name;
    EXPECT_THAT(run.reason, HasSubstr("has no state: ")) << name;
    EXPECT_THAT(run.reason, HasSubstr("the IMU")) << name;
    EXPECT_TRUE(run.nees.samples.empty()) << name;
    EXPECT_EQ(run.coverage_s, 0.0) << name;
    EXPECT_GT(run.dead_reckoned, 5) << name;
  }
}

// The errors count from the settling time on; without a state after it there is no error, not one
// of 0.
TEST(RunOnce, HasNoErrorWithoutStatesToTakeItOver) {
  MonteCarloOptions options;
  options.simulation = SimulationPreset("excited");
  options.simulation.duration_s = 1.0;
  options.simulation.max_tracks = 40;
  const auto run = [&](double settle_s) {
    options.settle_s = settle_s;
    return RunOnce(options, 1,
                   [&](const EstimatorSetup& setup) { return MakeEstimator("msckf", setup, {}); });
  };
  const MonteCarloRun none = run(2.0);
  EXPECT_TRUE(none.failed);
  EXPECT_THAT(none.reason, HasSubstr("come 2 s after the first or later"));
  EXPECT_TRUE(std::isnan(none.ate_position_m));
  EXPECT_TRUE(std::isnan(none.position_rms_m));
  const MonteCarloRun late = run(0.5);
  const MonteCarloRun all = run(0.0);
  EXPECT_FALSE(all.failed) << all.reason;
  EXPECT_GT(all.ate_position_m, 0.0);
  EXPECT_GT(late.ate_position_m, 0.0);
  EXPECT_NE(late.ate_position_m, all.ate_position_m);
}

// Without alignment the error is the unaligned one; the freer the alignment, the smaller.
TEST(RunOnce, TakesItsErrorAfterTheAlignmentAskedFor) {
  MonteCarloOptions options;
  options.simulation = SimulationPreset("excited");
  options.simulation.duration_s = 1.5;
  options.simulation.max_tracks = 40;
  options.settle_s = 0.0;
  const auto run = [&](AlignmentMode mode) {
    options.alignment = mode;
    return RunOnce(options, 1,
                   [&](const EstimatorSetup& setup) { return MakeEstimator("msckf", setup, {}); });
  };
  const MonteCarloRun none = run(AlignmentMode::kNone);
  EXPECT_NEAR(none.ate_position_m, none.position_rms_m, 1e-12);
  const double posyaw_m = run(AlignmentMode::kPositionYaw).ate_position_m;
  EXPECT_LT(posyaw_m, none.ate_position_m);
  EXPECT_LT(run(AlignmentMode::kSe3).ate_position_m, posyaw_m);
  options.alignment_options.min_spread_m = 100.0;  // further than the motion reaches
  EXPECT_TRUE(std::isnan(run(AlignmentMode::kPositionYaw).ate_position_m));
}

TEST(OutputCollector, TakesEachStateOnce) {
  MonteCarloRun run;
  OutputCollector collector(&run);
  EstimatorOutput output;
  output.frame_timestamp = 1;
  output.status = EstimatorStatus::kDeadReckoning;
  EXPECT_FALSE(collector.Add(output));  // skipped before there is a state
  output.status = EstimatorStatus::kTracking;
  output.covariance = Matrix15d::Identity();
  for (const Timestamp stamp : {2'000'000'000LL, 3'000'000'000LL}) {
    output.frame_timestamp = stamp;
    output.state.instant = stamp;
    EXPECT_TRUE(collector.Add(output));
  }
  output.frame_timestamp = 5'000'000'000;  // skipped: the state stays
  output.status = EstimatorStatus::kDeadReckoning;
  EXPECT_FALSE(collector.Add(output));
  collector.Finish();
  EXPECT_FALSE(run.failed);
  EXPECT_EQ(run.frames, 4);
  EXPECT_EQ(run.dead_reckoned, 2);
  EXPECT_EQ(run.coverage_s, 1.0);
  EXPECT_EQ(collector.first_frame(), 2'000'000'000);
}

}  // namespace
}  // namespace duet
