// duet report, from records to what a browser shows of the page.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "common/support/numeric_text.h"
#include "test/acceptance/program.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;
using testing::Not;

constexpr const char* kQuestion = "Is <b>\"a\"</b> & 'b' < c?";

constexpr const char* kStudy = R"(study: small
question: 'Is <b>"a"</b> & ''b'' < c?'
streams:
  - {name: room, simulate: room_easy, set: {simulation.duration_s: 4}}
seeds: 1..2
metrics: [ate.position_m, ate.orientation_deg, nees.pose, coverage_share]
)";

std::vector<std::string> Fields(const std::string& row) {
  std::vector<std::string> fields;
  std::istringstream text(row);
  for (std::string field; std::getline(text, field, ',');) fields.push_back(field);
  return fields;
}

std::vector<std::string> LastRow(const fs::path& csv) {
  std::string text = ReadFile(csv);
  text.pop_back();
  return Fields(text.substr(text.rfind('\n') + 1));
}

/// |p_true - p| at the record's last state, by its files.
double LastPositionError(const fs::path& record) {
  const std::vector<std::string> state = LastRow(record / "states.csv");
  const std::vector<std::string> truth = LastRow(record / "truth.csv");
  double sum = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    sum += std::pow(std::stod(truth.at(1 + k)) - std::stod(state.at(7 + k)), 2);
  }
  return std::sqrt(sum);
}

/// The record of the first seed's filter.
fs::path FirstRecord(const fs::path& study) {
  std::istringstream plan(ReadFile(study / "plan.csv"));
  std::string row;
  std::getline(plan, row);
  while (std::getline(plan, row)) {
    const std::vector<std::string> fields = Fields(row);
    if (fields.at(3) == "msckf" && fields.at(6) == "1") return study / "runs" / fields.at(0);
  }
  return {};
}

/// The first of these programs that is installed; empty: none.
std::string Installed(const std::vector<std::string>& programs) {
  for (const std::string& program : programs) {
    if (std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0) return program;
  }
  return "";
}

class ReportTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder();
    WriteFile(*folder_ / "study.yaml", kStudy);
    const ProgramResult study =
        RunDuet({"study", *folder_ / "study.yaml", "--out", Study(), "--quiet"});
    ASSERT_EQ(study.status, 0) << study.err;
    const ProgramResult report = RunDuet({"report", Study()});
    ASSERT_EQ(report.status, 0) << report.err;
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static std::string Study() { return *folder_ / "study"; }

  static TemporaryFolder* folder_;
};
TemporaryFolder* ReportTest::folder_ = nullptr;

TEST_F(ReportTest, OfAStudyHasItsWordsTablesAndRecords) {
  const std::string page = ReadFile(Study() + "/report.html");
  EXPECT_THAT(page, HasSubstr("Is &lt;b&gt;&quot;a&quot;&lt;/b&gt; &amp; &#39;b&#39; &lt; c?"));
  EXPECT_THAT(page, HasSubstr("position error"));
  EXPECT_THAT(page, HasSubstr("<td class=\"number best\">"));
  EXPECT_THAT(page, HasSubstr(FirstRecord(Study()).filename().string()));
  EXPECT_LT(page.size(), 5'000'000);
  // Again: the same bytes, in the place of the old ones.
  ASSERT_EQ(RunDuet({"report", Study()}).status, 0);
  EXPECT_EQ(ReadFile(Study() + "/report.html"), page);
}

TEST_F(ReportTest, OfOneRunRecord) {
  const std::string out = *folder_ / "run.html";
  const ProgramResult report = RunDuet({"report", FirstRecord(Study()), "--out", out});
  EXPECT_EQ(report.status, 0) << report.err;
  EXPECT_THAT(ReadFile(out), HasSubstr("\"estimators\":[\"msckf\"]"));
  const ProgramResult again = RunDuet({"report", FirstRecord(Study()), "--out", out});
  EXPECT_EQ(again.status, 2);
  EXPECT_THAT(again.err, HasSubstr("exists"));
}

TEST_F(ReportTest, RefusesWhatIsNoRecord) {
  const ProgramResult none = RunDuet({"report", *folder_ / "nothing"});
  EXPECT_EQ(none.status, 2);
  EXPECT_THAT(none.err, HasSubstr("expected a study's folder"));
  EXPECT_EQ(RunDuet({"report"}).status, 2);
  const ProgramResult place = RunDuet({"report", Study(), "--out", *folder_ / "no/such/page.html"});
  EXPECT_EQ(place.status, 4);
  EXPECT_THAT(place.err, HasSubstr("page.html"));
}

TEST_F(ReportTest, InABrowser) {
  const std::string node = Installed({"node", "nodejs"});
  const std::string browser = Installed({"chromium", "chromium-browser", "google-chrome"});
  if (node.empty() || browser.empty()) {
    GTEST_SKIP() << "SKIPPED: no browser on this machine (needs " << (node.empty() ? "nodejs " : "")
                 << (browser.empty() ? "chromium" : "") << "): what the page shows is not tested";
  }
  const std::string script = std::string(DUET_SOURCE) + "/test/acceptance/report/browser_test.mjs";
  const std::string log = *folder_ / "browser.log";
  const std::string command = node + " '" + script + "' " + browser + " '" + Study() +
                              "/report.html' '" + folder_->path().string() + "' " +
                              FormatNumber(LastPositionError(FirstRecord(Study()))) + " >'" + log +
                              "' 2>&1";
  ASSERT_EQ(setenv("DUET_QUESTION", kQuestion, 1), 0);
  EXPECT_EQ(std::system(command.c_str()), 0) << ReadFile(log);
  EXPECT_THAT(ReadFile(log), HasSubstr("all checks hold"));
}

}  // namespace
}  // namespace duet
