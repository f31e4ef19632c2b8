#include "experiments/study/study_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "backends/factory.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/simulation/monte_carlo.h"
#include "experiments/study/record_version.h"
#include "experiments/study/run_evaluation.h"
#include "experiments/study/study_products.h"
#include "experiments/study/study_records.h"
#include "experiments/study/study_stream.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kOneRun =
    "study: s\nstreams:\n  - name: room\n    simulate: room_easy\n"
    "    set: {simulation.duration_s: 4, simulation.max_tracks: 40}\n"
    "set: {evaluation.nees_settle_s: 0}\nestimators: [msckf]\nseeds: 3..3\n"
    "perturbations: [{name: told wrong, set: {shared.calibration.t_d.state: estimated,"
    " shared.calibration.told_errors: {t_d_s: 0.01}}}]\n";

class StudyRunTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("study_run_" + std::to_string(getpid()));
    fs::remove_all(folder_);
    MakeFolder(folder_);
    plan_ = MakeStudyPlan(ParseStudyFile(kOneRun, "s.yaml", false), "");
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
  StudyPlan plan_;
};

double Value(const NamedNumbers& metrics, const std::string& key) {
  for (const auto& [name, value] : metrics) {
    if (name == key) return value;
  }
  ADD_FAILURE() << "no " << key;
  return 0.0;
}

// What goes through files is what goes through memory: the same simulation, start and told
// calibration for a seed, and the same definitions.
TEST_F(StudyRunTest, IsTheMonteCarloRunOfItsSeed) {
  ASSERT_EQ(RunStudyRun(plan_, plan_.runs[0], folder_, ""), kDone);
  const RunEvaluation evaluation = ReadEvaluation(RecordFolderOf(folder_, plan_.runs[0].id));
  ASSERT_FALSE(evaluation.failed) << evaluation.reason;

  ConfigSources sources = SourcesOfRun(plan_, plan_.runs[0]);
  Configuration configuration;
  configuration.Read(&sources);
  MonteCarloOptions options;
  options.simulation = SimulationPreset("room_easy");
  options.simulation.duration_s = 4.0;
  options.simulation.max_tracks = 40;
  options.shared = configuration.shared;
  options.start = configuration.initialization;
  options.told_from_priors = false;
  options.settle_s = 0.0;
  const MonteCarloRun run =
      RunOnce(options, plan_.runs[0].draw_seed, [&](const EstimatorSetup& setup) {
        return MakeEstimator("msckf", setup, configuration.backends);
      });
  // The told t_d is off by milliseconds, so that instants lie between rows of the truth: linear
  // over 5 ms, which is micrometres, against errors of centimetres.
  EXPECT_NEAR(Value(evaluation.metrics, "rms.position_m"), run.position_rms_m, 2e-5);
  EXPECT_NEAR(Value(evaluation.metrics, "rms.orientation_deg"), run.orientation_rms_deg, 2e-3);
  const auto consistency = SummarizeRuns(std::vector<MonteCarloRun>{run}, 0.0);
  EXPECT_NEAR(Value(evaluation.metrics, "nees.pose"), consistency.blocks[0].mean,
              0.02 * consistency.blocks[0].mean);
  EXPECT_NEAR(Value(evaluation.metrics, "calibration.t_d.error"), run.calibration.error()[0], 1e-5);
  EXPECT_NEAR(Value(evaluation.metrics, "calibration.t_d.sigma"), run.calibration.sigma()[0], 1e-6);
  EXPECT_NEAR(Value(evaluation.metrics, "nees.calibration"), *run.calibration.Nees(), 0.05);
}

TEST_F(StudyRunTest, IsThereOnceHoweverOftenItIsRun) {
  ASSERT_EQ(RunStudyRun(plan_, plan_.runs[0], folder_, "first"), kDone);
  const fs::path record = RecordFolderOf(folder_, plan_.runs[0].id);
  const std::string manifest = ReadTextFile(record / "manifest.json");
  ASSERT_EQ(RunStudyRun(plan_, plan_.runs[0], folder_, "second"), kDone);
  EXPECT_EQ(ReadTextFile(record / "manifest.json"), manifest);
  int entries = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator(folder_ / "runs")) ++entries;
  EXPECT_EQ(entries, 1);
}

// Half of a record is none: it is made again, to the same bytes.
TEST_F(StudyRunTest, ADamagedRecordIsNoticedAndMadeAgain) {
  ASSERT_EQ(RunStudyRun(plan_, plan_.runs[0], folder_, ""), kDone);
  const fs::path record = RecordFolderOf(folder_, plan_.runs[0].id);
  EXPECT_EQ(DamageOfRecord(record), "");
  const std::string states = ReadTextFile(record / "states.csv");
  const std::string json = ReadTextFile(record / "study.json");
  for (const char* name : {"states.csv", "manifest.json", "study.json", "config.yaml"}) {
    const std::string whole = ReadTextFile(record / name);
    fs::remove(record / name);
    EXPECT_EQ(DamageOfRecord(record), std::string(name) + " is missing");
    WriteTextFile(record / name, whole);
  }
  WriteTextFile(record / "study.json", json.substr(0, json.size() / 2));
  EXPECT_EQ(DamageOfRecord(record), "study.json is torn");
  WriteTextFile(record / "study.json", json);
  WriteTextFile(record / "states.csv", states.substr(0, states.size() / 2));
  EXPECT_THAT(DamageOfRecord(record), HasSubstr("states.csv has "));
  ASSERT_EQ(RunStudyRun(plan_, plan_.runs[0], folder_, ""), kDone);
  EXPECT_EQ(ReadTextFile(record / "states.csv"), states);
  EXPECT_EQ(ReadTextFile(record / "study.json"), json);
}

// A run on another input than its id stands for is not made.
TEST_F(StudyRunTest, AStreamThatHasChangedIsNotRunOn) {
  ASSERT_TRUE(EnsureStream(plan_, plan_.streams[0], folder_));
  const fs::path stream = StreamFolder(folder_, plan_.streams[0].id);
  for (const char* name : {"mav0/imu0/data.csv", "mav0/imu0/sensor.yaml", "mav0/truth.yaml",
                           "mav0/state_groundtruth_estimate0/data.csv"}) {
    const std::string whole = ReadTextFile(stream / name);
    WriteTextFile(stream / name, whole + "\n");
    EXPECT_THAT([&] { (void)RunStudyRun(plan_, plan_.runs[0], folder_, ""); },
                ThrowsMessage<InputError>(HasSubstr(std::string(name) + ": has changed since")));
    fs::remove(stream / name);
    EXPECT_THAT([&] { (void)RunStudyRun(plan_, plan_.runs[0], folder_, ""); },
                ThrowsMessage<InputError>(HasSubstr(std::string(name) + ": is missing")));
    WriteTextFile(stream / name, whole);
  }
  WriteTextFile(stream / "mav0/more.csv", "");
  EXPECT_FALSE(ChangesOfStream(stream, ReadStreamInfo(stream)).empty());
  fs::remove(stream / "mav0/more.csv");
  EXPECT_EQ(RunStudyRun(plan_, plan_.runs[0], folder_, ""), kDone);
}

TEST_F(StudyRunTest, ACellWithoutARecordHasFailedAndSaysWhy) {
  MakeFolder(folder_ / "failures");
  WriteTextFile(folder_ / "study.yaml", StudyYaml(plan_.study));
  WriteTextFile(folder_ / "plan.csv", PlanCsv(plan_));
  StudyResult result = ReadStudy(folder_);
  ASSERT_EQ(result.runs.size(), 1U);
  EXPECT_TRUE(result.runs[0].failed);
  EXPECT_THAT(result.runs[0].reason, HasSubstr("did not run"));
  WriteTextFile(FailureFile(folder_, plan_.runs[0].id), "its process was ended by signal 9\n");
  result = ReadStudy(folder_);
  EXPECT_EQ(result.runs[0].reason, "its process was ended by signal 9");
  EXPECT_THAT(RunsCsv(result), HasSubstr(",room,msckf,default,told wrong,3,1,its process was"));
}

TEST(StudyRecordFiles, SizesAreNumbersOfBytes) {
  const auto with_size = [](const std::string& size) {
    return R"({"id": "1", "determined_by": "", "stream_id": "2", "sha256": {}, "bytes": {"a": )" +
           size + "}}";
  };
  EXPECT_EQ(ParseRecordInfo(with_size("7"), "f").bytes.at("a"), 7U);
  for (const char* size : {"-1", "1e300", "0.5", "null", "\"7\""}) {
    EXPECT_THAT([&] { (void)ParseRecordInfo(with_size(size), "f"); },
                ThrowsMessage<InputError>(HasSubstr("bytes.a: expected a size")));
  }
}

// They are removed when a study is done again.
TEST(StudyRecordFiles, AProductLiesWithinTheStudysFolder) {
  const auto with_product = [](const std::string& name) {
    return R"({"products": {")" + name + R"(": "00"}})";
  };
  EXPECT_EQ(ParseProducts(with_product("figures/a.csv"), "f").size(), 1U);
  EXPECT_TRUE(ParseProducts("{}", "f").empty());
  for (const char* name : {"/etc/passwd", "../a", "figures/../../a", "", ".", "figures/"}) {
    EXPECT_THAT([&] { (void)ParseProducts(with_product(name), "f"); },
                ThrowsMessage<InputError>(HasSubstr("expected a file within the folder")));
  }
  EXPECT_THROW((void)ParseProducts("[1]", "f"), InputError);
}

}  // namespace
}  // namespace duet
