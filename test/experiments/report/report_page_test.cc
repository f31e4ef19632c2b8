#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/support/input_error.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"
#include "experiments/report/report.h"
#include "experiments/report/web_bundle.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kHostile = R"html(</script><img src=x onerror="alert('1')">&<b>)html";

/// Three minutes at 20 Hz.
RunCurves LongCurves(double phase) {
  constexpr std::size_t kInstants = 3600;
  RunCurves curves;
  curves.all_instants = kInstants;
  for (std::size_t i = 0; i < kInstants; ++i) {
    curves.instants.push_back(1'000'000'000 + static_cast<Timestamp>(i) * 50'000'000);
    for (std::size_t c = 0; c < curves.columns.size(); ++c) {
      const double t = 0.01 * static_cast<double>(i);
      curves.columns[c].push_back(1.5 + std::sin(t * static_cast<double>(c + 1) + phase));
    }
  }
  curves.alignment = {Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(),
                      Eigen::Quaterniond::Identity()};
  return curves;
}

StudyTable SmallTable(const std::string& text) {
  StudyTable table;
  table.name = table.title = table.verdict = text;
  table.columns = {{.title = text, .is_text = true},
                   {.title = "median", .unit = "m", .group = text}};
  TableCell name;
  name.text = text;
  TableCell best;
  best.value = 0.25;
  best.mark = TableMark::kBest;
  table.rows.push_back({.section = text, .cells = {}});
  table.rows.push_back({.section = "", .cells = {name, best}});
  table.foot = {text};
  return table;
}

/// `text` wherever a report takes text from records.
Report ReportOf(int runs, const std::string& text) {
  Report report;
  report.kind = "study";
  report.title = report.question = text;
  report.summary = report.foot = {text};
  report.overview = SmallTable(text);
  report.tables = {SmallTable(text)};
  report.texts = {{text, text}};
  report.figures = {{text, text, "image/svg+xml", "<svg>" + std::string(60'000, 'x') + "</svg>"}};
  for (int i = 0; i < runs; ++i) {
    ReportRun& run = report.runs.emplace_back();
    run.run.id = run.run.stream = run.run.stream_id = run.run.reason = text;
    run.run.estimator = i % 2 == 0 ? "msckf" : "window";
    run.run.seed = i / 2;
    run.run.failed = i == 1;
    run.run.metrics = {{"ate.position_m", 0.1 * i}, {text, std::nan("")}};
    run.record = run.program = run.settings_sha256 = text;
  }
  return report;
}

void AddCurvesTo(Report* report) {
  const std::size_t most = InstantsThatFit(*report);
  double phase = 0.0;
  for (ReportRun& run : report->runs) run.curves = Thinned(LongCurves(phase += 0.1), most);
}

TEST(ReportPageTest, TextOfRecordsIsNeverMarkup) {
  Report report = ReportOf(2, kHostile);
  AddCurvesTo(&report);
  const std::string page = ReportPage(report);
  EXPECT_THAT(page, Not(HasSubstr("<img src=x")));
  EXPECT_THAT(page,
              HasSubstr("&lt;img src=x onerror=&quot;alert(&#39;1&#39;)&quot;&gt;&amp;&lt;b&gt;"));
  // Two scripts, each ended once: the data and the bundle.
  std::size_t ends = 0;
  for (std::size_t at = page.find("</script"); at != std::string::npos;
       at = page.find("</script", at + 1)) {
    ++ends;
  }
  EXPECT_EQ(ends, 2);
}

TEST(ReportPageTest, DataReadBackFromThePage) {
  Report report = ReportOf(3, kHostile);
  AddCurvesTo(&report);
  const std::string page = ReportPage(report);
  const std::string begin = "id=\"report-data\">";
  const std::size_t from = page.find(begin) + begin.size();
  const auto data = nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
  EXPECT_EQ(data["columns"].size(), kCurveColumns.size());
  EXPECT_EQ(data["estimators"], nlohmann::json({"msckf", "window"}));
  EXPECT_NEAR(data["nees"]["pose"]["band"][0].get<double>(), 1.237, 1e-3);  // chi-squared tables
  EXPECT_NEAR(data["nees"]["pose"]["band"][1].get<double>(), 14.449, 1e-3);
  ASSERT_EQ(data["runs"].size(), 3);
  const auto& run = data["runs"][1];
  EXPECT_EQ(run["reason"], kHostile);
  EXPECT_EQ(run["failed"], true);
  EXPECT_EQ(run["instants"], 3600);
  EXPECT_EQ(run["metrics"][0][0], "ate.position_m");
  EXPECT_EQ(run["metrics"][1][1], nullptr);
  EXPECT_EQ(run["curves"].get<std::string>().size(),
            EncodedSize(report.runs[1].curves->instants.size()));
}

TEST(ReportPageTest, TwentyLongRunsStayBelowFiveMegabytes) {
  Report report = ReportOf(20, "a study of twenty runs");
  report.figures.assign(12, report.figures.front());
  AddCurvesTo(&report);
  const std::string page = ReportPage(report);
  EXPECT_LT(page.size(), 5'000'000);
  EXPECT_GT(report.runs.front().curves->instants.size(), 700);  // and the room is used
}

TEST(ReportPageTest, SameReportSameBytes) {
  Report report = ReportOf(2, "x");
  AddCurvesTo(&report);
  EXPECT_EQ(ReportPage(report), ReportPage(report));
}

TEST(ReportPageTest, AsksForNothingElse) {
  const std::string page = ReportPage(ReportOf(1, "x"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'; img-src data:; style-src 'sha256-"));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
  EXPECT_THAT(page, Not(HasSubstr("src=\"http")));
}

TEST(ReportPageTest, MarksAndGroupsOfTables) {
  const std::string page = ReportPage(ReportOf(1, "x"));
  EXPECT_THAT(page,
              HasSubstr("<td class=\"number best\">0.250<span class=\"hidden\"> best</span>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"colgroup\" class=\"group\" colspan=\"1\">x</th>"));
  EXPECT_THAT(page, HasSubstr("<th scope=\"col\" class=\"number\">median [m]</th>"));
}

// The bundle in the program is the committed one, whose checksums stand beside it.
// The first answer the question; a grid of many cells has dozens.
TEST(ReportPageTest, OfManySentencesTheFirstAreShownAndTheOthersOnDemand) {
  Report report = ReportOf(1, "x");
  report.summary.clear();
  for (int i = 1; i <= 9; ++i) report.summary.push_back("Sentence " + std::to_string(i) + ".");
  const std::string page = ReportPage(report);
  const std::size_t more = page.find("<summary>2 more sentences</summary>");
  ASSERT_NE(more, std::string::npos);
  EXPECT_LT(page.find("Sentence 7."), more);
  EXPECT_GT(page.find("Sentence 8."), more);
  EXPECT_GT(page.find("Sentence 9."), more);
  report.summary.pop_back();
  EXPECT_THAT(ReportPage(report), Not(HasSubstr("more sentences")));
}

TEST(ReportPageTest, BundleHasItsChecksums) {
  const std::filesystem::path dist =
      std::filesystem::path(DUET_SOURCE) / "experiments/report/web/dist";
  std::istringstream sums(ReadTextFile(dist / "SHA256SUMS"));
  std::map<std::string, std::string> hash_of;
  for (std::string hash, name; sums >> hash >> name;) hash_of[name] = hash;
  const WebBundle bundle = GetWebBundle();
  EXPECT_EQ(Sha256Hex(bundle.script), hash_of.at("report.js"));
  EXPECT_EQ(Sha256Hex(bundle.style), hash_of.at("report.css"));
  EXPECT_EQ(Sha256Hex(bundle.licences), hash_of.at("LICENSES.txt"));
}

TEST(ReadReportTest, AFolderOfSomethingElseIsRefused) {
  EXPECT_THROW((void)ReadReport(testing::TempDir()), InputError);
}

}  // namespace
}  // namespace duet
