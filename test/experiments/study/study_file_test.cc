#include "experiments/study/study_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backends/factory.h"
#include "common/support/input_error.h"

namespace duet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kSmall =
    "study: small\n"
    "streams:\n"
    "  - {name: room, simulate: room_easy, set: {simulation.duration_s: 3}}\n";

StudyFile Parse(const std::string& yaml, bool quick = false) {
  return ParseStudyFile(yaml, "folder/s.yaml", quick);
}

TEST(StudyFileTest, WhatIsLeftOutHasItsDefault) {
  const StudyFile study = Parse(kSmall);
  EXPECT_EQ(study.name, "small");
  EXPECT_EQ(study.estimators, EstimatorNames());
  ASSERT_EQ(study.settings.size(), 1U);
  EXPECT_EQ(study.settings[0].name, "default");
  ASSERT_EQ(study.perturbations.size(), 1U);
  EXPECT_EQ(study.perturbations[0].name, "none");
  EXPECT_EQ(study.baseline, "default");
  EXPECT_EQ(study.seeds.first, 1);
  EXPECT_EQ(study.seeds.last, 1);
  EXPECT_FALSE(study.measure_time);
  EXPECT_EQ(study.streams[0].init, "drawn");
}

TEST(StudyFileTest, QuickReplacesKeysAndLeavesTheRest) {
  const std::string yaml = std::string(kSmall) + "seeds: 1..20\nquick: {seeds: 3..4}\n";
  EXPECT_EQ(Parse(yaml).seeds.last, 20);
  EXPECT_EQ(Parse(yaml, true).seeds.first, 3);
  EXPECT_EQ(Parse(yaml, true).streams.size(), 1U);
  EXPECT_THAT([] { Parse(kSmall, true); }, ThrowsMessage<InputError>(HasSubstr("quick")));
}

TEST(StudyFileTest, ItsTextSaysTheSame) {
  const StudyFile study = Parse(
      "study: all\nquestion: 'Is it: \"so\", or not?'\n"
      "streams:\n"
      "  - {name: chaos, simulate: room_easy, jitter_px: 0.001, simulation_seed: 7}\n"
      "  - {name: MH_01, dataset: MH_01_easy, cameras: [0, 1], starts_s: [0, 0.25], duration_s: "
      "9,\n"
      "     set: {frontend.threads: 2}, init: rest}\n"
      "estimators: [window]\n"
      "set: {shared: {calibration: {t_d: {state: estimated}}}, evaluation.alignment: 'se3'}\n"
      "settings:\n  - {name: a}\n  - {name: b, set: {window.max_frames: 7}}\n"
      "perturbations:\n  - {name: none}\n"
      "  - {name: off, set: {shared.calibration.told_offset.t_d_s: [0.01]}}\n"
      "seeds: 2..5\nbaseline: b\ncompare: settings\nmetrics: [ate.position_m]\n"
      "figures: [rmse_over_runs]\nmeasure_time: true\n");
  const std::string text = StudyYaml(study);
  EXPECT_EQ(StudyYaml(Parse(text)), text);
  EXPECT_THAT(text, HasSubstr("shared.calibration.t_d.state: estimated\n"));
  EXPECT_THAT(Parse(text).streams[1].starts_s, ElementsAre(0.0, 0.25));
  EXPECT_EQ(Parse(text).question, study.question);
}

// Lines' ends and keys that are no words too: the text is what the study's folder is read from.
TEST(StudyFileTest, ItsTextSaysTheSameWhateverStandsInIt) {
  const StudyFile study = Parse(
      "study: s\nquestion: \"a\\nb\\tc \\x01 \\\\ d\"\n"
      "streams: [{name: a, simulate: room_easy, init: rest}]\n"
      "set: {\"window.a: b\": '-', shared: {'#c': ['', ~, 'true']}}\n");
  const StudyFile again = Parse(StudyYaml(study));
  EXPECT_EQ(again.question, "a\nb\tc \x01 \\ d");
  ASSERT_EQ(again.set.size(), 2U);
  EXPECT_EQ(again.set[0].key, "window.a: b");
  EXPECT_EQ(again.set[1].key, "shared.#c");
  EXPECT_EQ(StudyYaml(again), StudyYaml(study));
}

TEST(StudyFileTest, OfAKeyThatStandsTwiceTheLaterRules) {
  const StudyFile study =
      Parse(std::string(kSmall) + "set: {window.max_frames: 7, window: {max_frames: 9}}\n");
  ASSERT_EQ(study.set.size(), 1U);
  EXPECT_EQ(study.set[0].value.scalar, "9");
}

struct BadStudy {
  std::string yaml;
  std::string error;
};

class BadStudyTest : public testing::TestWithParam<BadStudy> {};

TEST_P(BadStudyTest, IsRefusedInOneLineThatNamesTheKey) {
  EXPECT_THAT([] { Parse(GetParam().yaml); },
              ThrowsMessage<InputError>(HasSubstr(GetParam().error)));
}

const std::string kStudy = kSmall;

INSTANTIATE_TEST_SUITE_P(
    All, BadStudyTest,
    testing::Values(
        BadStudy{"study: s\nstreams: []\n", "s.yaml:2: streams: is empty"},
        BadStudy{"study: s\n", "streams: is missing"},
        BadStudy{kStudy + "seed: 1..2\n", "s.yaml:4: seed: unknown key; did you mean 'seeds'?"},
        BadStudy{kStudy + "seeds: 4..2\n", "s.yaml:4: seeds: expected A..B"},
        BadStudy{kStudy + "estimators: [msckv]\n",
                 "estimators: 'msckv' is unknown; did you mean 'msckf'?"},
        BadStudy{kStudy + "estimators: []\n", "estimators: is empty"},
        BadStudy{kStudy + "estimators: [window, window]\n", "stands there twice"},
        BadStudy{kStudy + "settings:\n  - {name: a}\n  - {name: a}\n", "two are called 'a'"},
        BadStudy{kStudy + "settings:\n  - {name: a, sett: {}}\n",
                 "settings[0].sett: unknown key; did you mean 'set'?"},
        BadStudy{kStudy + "settings:\n  - {name: 'a,b'}\n", "expected a name"},
        BadStudy{kStudy + "settings:\n  - {name: a, set: {frontend.threads: 2}}\n",
                 "frontend.threads: has no place here"},
        BadStudy{kStudy + "baseline: none of these\n", "is the name of none"},
        BadStudy{kStudy + "metrics: [ate.positon_m]\n", "did you mean 'ate.position_m'?"},
        BadStudy{kStudy + "compare: setings\n", "did you mean 'settings'?"},
        BadStudy{kStudy + "quick: {seeds: none}\n", "seeds: expected A..B"},
        BadStudy{kStudy + "quick: {sedes: 1..2}\n", "sedes: unknown key"},
        BadStudy{kStudy + "config: [no/such.yaml]\n", "folder/no/such.yaml does not exist"},
        BadStudy{kStudy + "config: [" + std::string(300, 'a') + "]\n", "a does not exist"},
        BadStudy{kStudy + "published: " + std::string(300, 'a') + "\n", "a is no folder"},
        BadStudy{"study: s\nstreams:\n  - {name: a}\n", "expected one of simulate"},
        BadStudy{"study: s\nstreams:\n  - {name: a, simulate: x, dataset: y}\n",
                 "expected one of simulate"},
        BadStudy{"study: s\nstreams:\n  - {name: a, simulate: x, starts_s: [1]}\n",
                 "starts_s: is of a data set"},
        BadStudy{"study: s\nstreams:\n  - {name: a, dataset: x, starts_s: [1, 1]}\n",
                 "holds a start twice"},
        BadStudy{"study: s\nstreams:\n  - {name: a, simulate: x, set: {simulation.seed: 2}}\n",
                 "expected simulation_seed"},
        BadStudy{"study: s\nstreams:\n  - {name: a, simulate: x, init: resting}\n",
                 "init: expected groundtruth"}));

}  // namespace
}  // namespace duet
