#include "experiments/study/study_plan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <utility>

#include "common/support/input_error.h"
#include "experiments/study/study_records.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::string WithStream(const std::string& stream, const std::string& rest) {
  return "study: s\nstreams:\n  - " + stream + "\n" + rest;
}
const std::string kRoom = "{name: room, simulate: room_easy, set: {simulation.duration_s: 3}}";

StudyPlan PlanOf(const std::string& yaml) {
  return MakeStudyPlan(ParseStudyFile(yaml, "folder/s.yaml", false), "");
}

std::set<std::string> IdsOf(const StudyPlan& plan) {
  std::set<std::string> ids;
  for (const PlannedRun& run : plan.runs) ids.insert(run.id);
  return ids;
}

TEST(StudyPlanTest, TheGridIsEveryCombination) {
  const StudyPlan plan = PlanOf(WithStream(
      kRoom,
      "settings: [{name: a}, {name: b, set: {msckf.max_clones: 9, window.max_frames: 9}}]\n"
      "perturbations: [{name: none}, {name: p, set: {shared.pixel_noise_px: 2}}]\n"
      "seeds: 1..3\n"));
  EXPECT_EQ(plan.runs.size(), 2U * 2U * 2U * 3U);
  EXPECT_EQ(IdsOf(plan).size(), plan.runs.size());
  EXPECT_EQ(plan.streams.size(), 3U);  // one a seed, shared by everything else
  EXPECT_EQ(plan.Distinct().size(), plan.runs.size());
  // The first runs open one stream each.
  std::set<int> opened;
  for (int i = 0; i < 3; ++i) {
    opened.insert(plan.runs[static_cast<std::size_t>(plan.Distinct()[static_cast<std::size_t>(i)])]
                      .planned_stream);
  }
  EXPECT_EQ(opened.size(), 3U);
}

TEST(StudyPlanTest, IdsAreOfWhatDeterminesARunAndNotOfNames) {
  const StudyPlan one = PlanOf(WithStream(kRoom, "settings: [{name: a}]\nseeds: 1..2\n"));
  const StudyPlan renamed = PlanOf(
      "study: other\nquestion: why\nstreams:\n  - {name: hall, simulate: room_easy, set: "
      "{simulation: {duration_s: 3.0}}}\nsettings: [{name: b, set: {window.max_frames: 11}}]"
      "\nseeds: 1..2\n");  // what is set is the default
  EXPECT_EQ(IdsOf(one), IdsOf(renamed));
  const StudyPlan longer = PlanOf(WithStream(
      "{name: room, simulate: room_easy, set: {simulation.duration_s: 4}}", "seeds: 1..2\n"));
  for (const std::string& id : IdsOf(longer)) EXPECT_FALSE(IdsOf(one).contains(id));
}

TEST(StudyPlanTest, AGrownGridKeepsItsIds) {
  const StudyPlan small = PlanOf(WithStream(kRoom, "seeds: 1..2\n"));
  const StudyPlan grown =
      PlanOf(WithStream(kRoom,
                        "seeds: 1..4\nsettings: [{name: default}, {name: b, set: "
                        "{shared.pixel_noise_px: 2}}]\n"));
  for (const std::string& id : IdsOf(small)) EXPECT_TRUE(IdsOf(grown).contains(id));
}

TEST(StudyPlanTest, WhatOneEstimatorDoesNotSeeIsNotRunForItAgain) {
  const StudyPlan plan = PlanOf(
      WithStream(kRoom, "settings: [{name: a}, {name: b, set: {window.max_iterations: 2}}]\n"));
  EXPECT_EQ(plan.runs.size(), 4U);
  EXPECT_EQ(IdsOf(plan).size(), 3U);
  EXPECT_EQ(plan.Distinct().size(), 3U);
}

TEST(StudyPlanTest, AJitteredStreamIsOneWorldForAllSeeds) {
  const StudyPlan plan = PlanOf(WithStream(
      "{name: chaos, simulate: room_easy, jitter_px: 0.001, simulation_seed: 4}", "seeds: 1..3\n"));
  EXPECT_EQ(plan.streams.size(), 3U);
  for (const PlannedRun& run : plan.runs) {
    EXPECT_EQ(run.draw_seed, 4);  // the start as well
    EXPECT_EQ(plan.InputOf(run).simulation_seed, 4);
    EXPECT_EQ(plan.InputOf(run).jitter_seed, run.seed);
  }
}

// Else the pairs of a seed on several streams would share their noise, and a test over all streams
// would take them as independent.
TEST(StudyPlanTest, EachStreamDrawsWithSeedsOfItsOwn) {
  const auto seeds_of = [](const StudyPlan& plan) {
    std::map<std::pair<std::string, int>, int> seeds;
    for (const PlannedRun& run : plan.runs) {
      EXPECT_EQ(plan.InputOf(run).simulation_seed, run.draw_seed);
      const std::string& stream = plan.StreamOf(run).name;
      EXPECT_EQ(seeds.emplace(std::pair(stream, run.seed), run.draw_seed).first->second,
                run.draw_seed);  // every estimator, setting and perturbation the same
    }
    return seeds;
  };
  const std::string settings =
      "settings: [{name: a}, {name: b, set: {msckf.max_clones: 9}}]\n"
      "perturbations: [{name: none}, {name: p, set: {shared.pixel_noise_px: 2}}]\nseeds: 1..20\n";
  const std::string fast = "{name: fast, simulate: excited, set: {simulation.duration_s: 3}}";
  const auto two = seeds_of(PlanOf(WithStream(kRoom + "\n  - " + fast, settings)));
  std::set<int> distinct;
  for (const auto& [where, seed] : two) distinct.insert(seed);
  EXPECT_EQ(two.size(), 40U);
  EXPECT_EQ(distinct.size(), two.size());
  // Whatever other streams there are, and in which order.
  const auto turned = seeds_of(PlanOf(WithStream(fast + "\n  - " + kRoom, settings)));
  EXPECT_EQ(turned, two);
  // One recording for all seeds is the one that the file names; what is drawn is not.
  const StudyPlan one =
      PlanOf(WithStream("{name: room, simulate: room_easy, simulation_seed: 4}", "seeds: 1..2\n"));
  EXPECT_EQ(one.streams.size(), 1U);
  EXPECT_EQ(one.streams[0].simulation_seed, 4);
  EXPECT_NE(one.runs[0].draw_seed, one.runs[1].draw_seed);
}

TEST(StudyPlanTest, TheRunsSettingsAreWhatTheFileSays) {
  const StudyPlan plan = PlanOf(WithStream(
      "{name: room, simulate: room_easy, set: {simulation.pixel_noise_px: 0.4}}",
      "set: {msckf.max_clones: 8}\nsettings: [{name: a, set: {msckf.max_clones: 9}}]\nseeds: 6..6"
      "\n"));
  ConfigSources sources = SourcesOfRun(plan, plan.runs.front());
  Configuration configuration;
  configuration.Read(&sources);
  EXPECT_EQ(configuration.backends.msckf.max_clones, 9);
  EXPECT_EQ(configuration.shared.pixel_noise_px, 0.4);  // as the simulator tells it
  EXPECT_EQ(configuration.shared.calibration.told_errors_seed, plan.runs.front().draw_seed);
}

TEST(StudyPlanTest, ThePlansTableReadsBack) {
  const StudyPlan plan = PlanOf(WithStream(kRoom, "seeds: 1..2\n"));
  EXPECT_THAT(PlanCsv(plan), HasSubstr(plan.runs[1].id + "," + plan.InputOf(plan.runs[1]).id +
                                       ",room,msckf,default,none,2\n"));
}

TEST(StudyPlanTest, APlansTableIsReadStrictly) {
  const std::string row = "1f,2e,room,msckf,default,none,";
  const std::vector<StudyRun> runs = ParsePlan(row + "2147483647\n", "p");
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].seed, 2147483647);
  for (const auto& [text, error] : std::vector<std::pair<std::string, std::string>>{
           {row + "2147483648\n", "p:1: seed: expected the seed of a run"},
           {row + "-1\n", "seed: expected an integer"},
           {"1f/../..,2e,room,msckf,default,none,1\n", "id: expected an id of at most 64"},
           {"1f,,room,msckf,default,none,1\n", "stream_id: expected an id of at most 64"},
           {"1" + std::string(64, '0') + ",2e,room,msckf,default,none,1\n", "id: expected an id"},
           {"1f,2e,,msckf,default,none,1\n", "stream: is empty; expected a name"},
           {"1f,2e,room,msckf,,none,1\n", "setting: is empty; expected a name"},
           {"#id\n", "has no rows"}}) {
    EXPECT_THAT([&] { (void)ParsePlan(text, "p"); }, ThrowsMessage<InputError>(HasSubstr(error)));
  }
}

TEST(StudyPlanTest, ListsOfRecordingsAreReadStrictly) {
  const auto with_frames = [](const std::string& frames) {
    return R"({"a [0]": {"path": "/a", "fingerprint_sha256": "f", "has_images": true, "frames": )" +
           frames + "}}";
  };
  EXPECT_EQ(ParseRecordings(with_frames("2147483647"), "r").at("a [0]").frames, 2147483647);
  for (const char* frames : {"2147483648", "-1", "1e300", "0.5", "null"}) {
    EXPECT_THAT([&] { (void)ParseRecordings(with_frames(frames), "r"); },
                ThrowsMessage<InputError>(HasSubstr("frames: expected a number of frames")));
  }
  EXPECT_THAT([] { (void)ParseRecordings("[]", "r"); },
              ThrowsMessage<InputError>(HasSubstr("no list of recordings")));
}

TEST(StudyPlanTest, ThePlansYamlGivesTheSamePlanFromAnywhere) {
  const StudyPlan plan = PlanOf(WithStream(
      "{name: a, simulate: room_easy, jitter_px: 0.01, set: {simulation.pixel_noise_px: 0.4}}",
      "set: {shared.pixel_noise_px: 2}\nseeds: 2..3\nfigures: []\nskip_missing: true\n"
      "settings: [{name: x}, {name: y, only: {msckf: {msckf.max_clones: 9}}}]\n"));
  const StudyFile again = ParseStudyFile(StudyYaml(plan.study), "elsewhere/study.yaml", false);
  EXPECT_EQ(PlanCsv(MakeStudyPlan(again, "")), PlanCsv(plan));
  EXPECT_TRUE(again.skip_missing);
  ASSERT_TRUE(again.figures.has_value());
  EXPECT_TRUE(again.figures->empty());
  // Paths count from the study's file, or from --data.
  StudyStream stream;
  stream.dataset = "MH";
  MakePathsAbsolute("/studies/s.yaml", "", &stream);
  EXPECT_EQ(stream.dataset, "/studies/MH");
  stream.dataset = "MH";
  MakePathsAbsolute("/studies/s.yaml", "/data", &stream);
  EXPECT_EQ(stream.dataset, "/data/MH");
}

// Of a recording the seed decides nothing where nothing is drawn: it is in no id. What is known of
// a recording is enough for a plan, wherever it has gone.
TEST(StudyPlanTest, ARecordingsSeedCountsOnlyWhereSomethingIsDrawn) {
  const StudyRecordings known = {
      {"/gone/MH [0]", {.path = "/gone/MH", .fingerprint = "f", .frames = 40}}};
  const auto plan = [&](const std::string& init, const std::string& seeds) {
    const std::string yaml =
        WithStream("{name: MH, dataset: /gone/MH, starts_s: [0, 5], init: " + init + "}",
                   "skip_missing: true\nseeds: " + seeds + "\n");
    return MakeStudyPlan(ParseStudyFile(yaml, "s.yaml", false), "", known);
  };
  EXPECT_EQ(plan("groundtruth", "1..2").runs.size(), 4U);
  EXPECT_EQ(IdsOf(plan("groundtruth", "1..2")), IdsOf(plan("groundtruth", "3..9")));
  EXPECT_NE(IdsOf(plan("drawn", "1..2")), IdsOf(plan("drawn", "3..4")));
}

TEST(StudyPlanTest, SeedsAreNoMoreThanAnIntHolds) {
  EXPECT_EQ(PlanOf(WithStream(kRoom, "seeds: 99999999..99999999\n")).runs.front().seed, 99999999);
  for (const char* seeds : {"1..4294967298", "4294967297..4294967298", "1..100000000", "-1..2",
                            "+1..2", " 1..2", "1..", "..2", "1...2", "2..1"}) {
    EXPECT_THAT([&] { (void)ParseSeeds(seeds); },
                ThrowsMessage<InputError>(HasSubstr("expected A..B")))
        << seeds;
  }
}

TEST(StudyPlanTest, TheShippedStudiesAreWhole) {
  int studies = 0;
  for (const auto& entry : std::filesystem::directory_iterator(DUET_SOURCE "/configs/studies")) {
    if (entry.is_directory()) continue;
    if (entry.path().filename() == "told_wrong.yaml") continue;           // of duet ablate
    if (entry.path().filename().string().starts_with("euroc")) continue;  // wants the recordings
    ++studies;
    for (const bool quick : {false, true}) {
      const StudyPlan plan = MakeStudyPlan(ReadStudyFile(entry.path(), quick), "");
      EXPECT_EQ(plan.study.name + ".yaml", entry.path().filename());
      EXPECT_FALSE(plan.study.question.empty());
      EXPECT_FALSE(plan.study.metrics.empty());
      // A quick one is over within minutes: twelve cells, nine seeds (fewer show nothing after
      // Holm's correction).
      EXPECT_LE(plan.Distinct().size(), quick ? 108U : 1000U) << entry.path();
    }
  }
  EXPECT_EQ(studies, 8);
}

struct BadPlan {
  std::string yaml;
  std::string error;
};
class BadPlanTest : public testing::TestWithParam<BadPlan> {};
TEST_P(BadPlanTest, IsRefusedBeforeAnythingRuns) {
  EXPECT_THAT([] { PlanOf(GetParam().yaml); },
              ThrowsMessage<InputError>(HasSubstr(GetParam().error)));
}
INSTANTIATE_TEST_SUITE_P(
    All, BadPlanTest,
    testing::Values(
        BadPlan{WithStream("{name: a, simulate: room_esay}", ""),
                "unknown preset 'room_esay'; did you mean 'room_easy'?"},
        BadPlan{WithStream("{name: a, simulate: room_easy, set: {simulation.duratoin_s: 3}}", ""),
                "s.yaml:3: simulation.duratoin_s: unknown key; did you mean 'duration_s'?"},
        BadPlan{WithStream(kRoom, "settings: [{name: a, set: {msckf.max_clone: 9}}]\n"),
                "s.yaml:4: msckf.max_clone: unknown key; did you mean 'max_clones'?"},
        BadPlan{WithStream(kRoom, "settings: [{name: a, set: {msckf.max_clones: 1}}]\n"),
                "expected an integer from 3 to 100"},
        BadPlan{WithStream("{name: a, simulate: room_easy, set: {simulation.duration_s: 0}}", ""),
                "s.yaml:3: streams.a: duration_s: expected above 0 s"},
        BadPlan{WithStream("{name: MH, dataset: nowhere/MH_01_easy}", "skip_missing: true\n"),
                "none of the recordings is there"},
        BadPlan{WithStream("{name: MH, dataset: " + std::string(300, 'a') + "}", ""),
                "a does not exist; expected a recording"},
        BadPlan{WithStream("{name: MH, dataset: nowhere/MH_01_easy}", ""),
                "nowhere/MH_01_easy does not exist; expected a recording (--data"}));

// What no seed could start with is said before anything is simulated or tracked, by the change
// without which it would not be so.
TEST(StudyPlanTest, AToldCalibrationThatCannotBeIsRefusedByName) {
  const std::string offset = "shared.calibration.told_offset.";
  const auto error_of = [](const std::string& rest) -> std::string {
    try {
      PlanOf(WithStream(kRoom, rest));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string focal = offset + "intrinsics_px: [-500, 0, 0, 0]";
  EXPECT_THAT(error_of("perturbations: [{name: none}, {name: far, set: {" + focal + "}}]\n"),
              HasSubstr("folder/s.yaml: perturbations.far: on stream room: " + offset +
                        "intrinsics_px: the told fx of camera 0 is -41.3"));
  // Beside a setting that has nothing to do with it; and of a setting.
  EXPECT_THAT(error_of("settings: [{name: two, set: {shared.pixel_noise_px: 2}}]\n"
                       "perturbations: [{name: far, set: {" +
                       focal + "}}]\n"),
              HasSubstr("s.yaml: perturbations.far: on"));
  EXPECT_THAT(error_of("settings: [{name: far, set: {" + focal + "}}]\n"),
              HasSubstr("s.yaml: settings.far: on"));
  EXPECT_THAT(error_of("settings: [{name: far, only: {window: {" + focal + "}}}]\n"),
              HasSubstr("s.yaml: settings.far: on"));
  EXPECT_THAT(error_of("set: {" + focal + "}\n"), HasSubstr("s.yaml: set: on stream room"));
  // Times beyond their bounds, which a setting may widen; lists of a wrong length; no such camera.
  const std::string late = "perturbations: [{name: late, set: {" + offset + "t_r_s: [0.08]}}]\n";
  EXPECT_THAT(error_of(late), HasSubstr("perturbations.late: on stream room: shared.max_abs_t_r_s: "
                                        "is 0.05; expected at least the told t_r, 0.08 s"));
  EXPECT_EQ(error_of("settings: [{name: wide, set: {shared.max_abs_t_r_s: 0.1}}]\n" + late),
            "no error");
  EXPECT_THAT(error_of("perturbations: [{name: p, set: {" + offset + "t_d_s: [0.01, 0.02]}}]\n"),
              HasSubstr("perturbations.p: on stream room: " + offset + "t_d_s: has 2 numbers"));
  EXPECT_THAT(error_of("settings: [{name: b, set: {shared.calibration.cameras: [1]}}]\n"),
              HasSubstr("settings.b: on stream room: shared.calibration.cameras: names camera 1"));
  // The gauge: what is estimated by the setting, and how the axes are tied by the perturbation.
  EXPECT_THAT(
      error_of("settings: [{name: all, set: {shared.calibration.T_g.state: estimated, "
               "shared.calibration.T_a.state: estimated, shared.calibration.R_CB.state: "
               "estimated}}]\n"
               "perturbations: [{name: tied, set: {shared.calibration.imu_frame: camera}}]\n"),
      HasSubstr("settings.all, perturbations.tied: on stream room: shared.calibration.imu_frame: "
                "camera ties"));
  // What is drawn is no matter of the configuration.
  EXPECT_EQ(error_of("perturbations: [{name: p, set: {shared.calibration.told_errors."
                     "intrinsics_px: 400}}]\nseeds: 1..9\n"),
            "no error");
}

// Of a recording by its own calibration, where that has been read.
TEST(StudyPlanTest, AToldCalibrationIsHeldAgainstTheRecordingsOwn) {
  RigCalibration rig;
  rig.cameras.resize(1);
  CameraModel::Parameters parameters(9);
  parameters << 100.0, 100.0, 376.0, 240.0, 0.0, 0.0, 0.0, 0.0, 0.0;
  rig.cameras[0].model = CameraModel(DistortionModel::kRadialTangential, 752, 480, parameters);
  StudyRecordings known = {
      {"/gone/MH [0]", {.path = "/gone/MH", .fingerprint = "f", .frames = 40, .rig = rig}}};
  const auto plan = [&] {
    return MakeStudyPlan(
        ParseStudyFile(WithStream("{name: MH, dataset: /gone/MH, init: rest}",
                                  "perturbations: [{name: far, set: {shared.calibration.told_offset"
                                  ".intrinsics_px: [-150, 0, 0, 0]}}]\n"),
                       "s.yaml", false),
        "", known);
  };
  EXPECT_THAT(plan, ThrowsMessage<InputError>(HasSubstr(
                        "s.yaml: perturbations.far: on stream MH: shared.calibration.told_offset."
                        "intrinsics_px: the told fx of camera 0 is -50 px")));
  known.begin()->second.rig.reset();  // as recordings.json knows it
  EXPECT_EQ(plan().runs.size(), 2U);
}

}  // namespace
}  // namespace duet
