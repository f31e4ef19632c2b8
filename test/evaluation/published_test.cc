#include "evaluation/published.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/support/input_error.h"
#include "evaluation/sequence_facts.h"

namespace duet {
namespace {

std::filesystem::path ShippedFolder() {
  return std::filesystem::path(DUET_SOURCE_DIR) / "configs" / "studies" / "published";
}

constexpr const char* kHead =
    "# name: X\n# source: a paper\n# alignment: se3\n# covers: position\n"
    "#sequence,position_rmse_m,orientation_rmse_deg\n";

TEST(Published, ShippedFilesHaveTheThesissAveragesAndSources) {
  const Published published = ReadPublished(ShippedFolder());
  ASSERT_EQ(published.numbers.size(), 9u);
  // Average positions as they are tabulated, some of them cut off after three digits.
  const std::vector<std::pair<std::string, double>> averages = {{"VINS-Fusion (thesis)", 0.415},
                                                                {"VINS-EKF (thesis)", 0.440},
                                                                {"VINS-Mono", 0.110},
                                                                {"XRSLAM", 0.125},
                                                                {"OpenVINS mono", 0.150},
                                                                {"VINS-Fusion mono", 0.202},
                                                                {"VINS-Fusion stereo", 0.138},
                                                                {"Basalt stereo", 0.072}};
  for (const auto& [name, average] : averages) {
    bool found = false;
    for (const PublishedNumbers& numbers : published.numbers) {
      if (numbers.name != name) continue;
      found = true;
      double sum = 0.0;
      for (const PublishedRow& row : numbers.rows) sum += row.position_rmse_m;
      EXPECT_NEAR(sum / static_cast<double>(numbers.rows.size()), average, 0.001) << name;
      EXPECT_FALSE(numbers.source.empty());
    }
    EXPECT_TRUE(found) << name;
  }
  ASSERT_EQ(published.sequences.size(), 1u);
  EXPECT_EQ(published.sequences[0].rows.size(), 11u);
  // Length, duration and speed of a row belong together (speeds have two digits).
  for (const SequenceRow& row : published.sequences[0].rows) {
    EXPECT_NEAR(row.length_m / row.duration_s, row.speed_m_per_s, 0.0101) << row.sequence;
  }
}

TEST(Published, BadFilesAreRefused) {
  const auto error_of = [](const std::string& text) -> std::string {
    try {
      (void)ParsePublishedNumbers(text, "x.csv");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(std::string(kHead) + "MH_01_easy,0.1,\n"), "");
  EXPECT_THAT(error_of("#sequence,position_rmse_m,orientation_rmse_deg\nMH_01_easy,0.1,\n"),
              testing::HasSubstr("name: expected a line \"# name: ...\""));
  EXPECT_THAT(error_of("# name: X\nMH_01_easy,0.1,\n"), testing::HasSubstr("#sequence,position"));
  EXPECT_THAT(error_of(std::string(kHead) + "A,0.1,\nA,0.2,\n"), testing::HasSubstr("twice"));
  EXPECT_THAT(error_of(std::string(kHead) + "A,wide,\n"), testing::HasSubstr("x.csv:6"));
  EXPECT_THAT(error_of(kHead), testing::HasSubstr("x.csv"));
  EXPECT_THROW((void)ReadPublished("/nowhere"), InputError);
}

TEST(Published, StudyStandsBesideThemOnTheSequencesThatWereRun) {
  StudyResult study;
  study.name = "euroc";
  for (const char* stream : {"MH_01_easy", "V1_01_easy", "my own"}) {
    for (const char* estimator : {"msckf", "window"}) {
      StudyRun run;
      run.id = std::string(stream) + estimator;
      run.stream = stream;
      run.estimator = estimator;
      run.metrics = {{"ate.position_m", run.estimator == "msckf" ? 0.2 : 0.1},
                     {"ate.orientation_deg", 1.0},
                     {"coverage_share", 1.0},
                     {"truth.way_m", run.stream == "MH_01_easy" ? 80.0 : 58.0}};
      study.runs.push_back(run);
    }
  }
  StudyTableOptions options;
  options.metrics = {"ate.position_m"};
  options.published = std::make_shared<Published>(ReadPublished(ShippedFolder()));
  const auto tables = MakeStudyTables(study, options);
  const StudyTable* position = nullptr;
  const StudyTable* sequences = nullptr;
  for (const StudyTable& table : tables) {
    if (table.name == "published.ate.position_m") position = &table;
    if (table.name == "sequences") sequences = &table;
  }
  ASSERT_NE(position, nullptr);
  ASSERT_NE(sequences, nullptr);
  EXPECT_EQ(position->rows.size(), 12u);  // eleven sequences and their mean
  const TableRow& mean = position->rows.back();
  EXPECT_EQ(mean.cells[0].text, "mean of the 2 run whole");
  EXPECT_NEAR(mean.cells[1].value, 0.2, 1e-12);
  EXPECT_NEAR(mean.cells[2].value, 0.1, 1e-12);
  for (std::size_t c = 1; c < mean.cells.size(); ++c) {
    if (position->columns[c].title != "VINS-EKF (thesis)") continue;
    EXPECT_NEAR(mean.cells[c].value, (0.590 + 0.142) / 2.0, 1e-12);
  }
  EXPECT_THAT(position->verdict, testing::HasSubstr("not in one ranking"));
  EXPECT_EQ(sequences->rows[0].cells[1].value, 80.0);
  EXPECT_EQ(sequences->rows[0].cells[2].value, 80.6);
  // A piece of a sequence is in no mean.
  for (StudyRun& run : study.runs) {
    if (run.stream == "MH_01_easy") run.metrics[3].second = 5.0;
  }
  for (const StudyTable& table : MakeStudyTables(study, options)) {
    if (table.name != "published.ate.position_m") continue;
    EXPECT_EQ(table.rows[0].cells[0].text, "MH_01_easy (6 % of it)");
    EXPECT_EQ(table.rows.back().cells[0].text, "mean of the 1 run whole");
  }
  // Of a study on other streams there is no such table.
  for (StudyRun& run : study.runs) run.stream = "my own";
  for (const StudyTable& table : MakeStudyTables(study, options)) {
    EXPECT_FALSE(table.name.starts_with("published."));
  }
}

TEST(SequenceFacts, CircleHasItsLengthAndRate) {
  // Radius 2 m, 0.5 rad/s, heading along the way, 10 s at 200 Hz.
  std::vector<StampedPose> truth;
  for (int i = 0; i <= 2000; ++i) {
    const double angle = 0.5 * i / 200.0;
    truth.push_back({static_cast<Timestamp>(i) * 5'000'000,
                     {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
                      {2.0 * std::cos(angle), 2.0 * std::sin(angle), 1.0}}});
  }
  const SequenceFacts facts = FactsOfTruth(truth, 0, truth.back().timestamp);
  EXPECT_NEAR(facts.duration_s, 10.0, 1e-9);
  EXPECT_NEAR(facts.way_m, 10.0, 0.002);  // chords of 0.05 rad are short by 1e-4
  EXPECT_NEAR(facts.speed_m_per_s, 1.0, 2e-4);
  EXPECT_NEAR(facts.rate_rad_per_s, 0.5, 1e-6);
  EXPECT_EQ(FactsOfTruth({}, 0, 1).way_m, 0.0);
}

}  // namespace
}  // namespace duet
