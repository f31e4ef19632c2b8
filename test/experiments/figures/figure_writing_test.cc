#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/support/text_file.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_layout.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/thinning.h"
#include "test/experiments/figures/test_records.h"

namespace duet {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Thinning, KeepsEndsAndExtremesOfEveryColumnAndGaps) {
  std::vector<double> a(10000);
  std::vector<double> b(10000);
  for (std::size_t i = 0; i < a.size(); ++i) {
    a[i] = std::sin(0.001 * static_cast<double>(i));
    b[i] = std::cos(0.7 * static_cast<double>(i));
  }
  a[1234] = 50.0;
  a[1235] = -60.0;
  b[8888] = 70.0;
  b[4001] = kNan;
  const std::vector<std::size_t> rows = ThinnedRows({a, b}, 400);
  EXPECT_LE(rows.size(), 820u);  // two rows a column and stretch, the ends, the gap
  EXPECT_EQ(rows.front(), 0u);
  EXPECT_EQ(rows.back(), 9999u);
  for (const std::size_t kept : {1234u, 1235u, 8888u, 4001u}) {
    EXPECT_TRUE(std::binary_search(rows.begin(), rows.end(), kept)) << kept;
  }
  EXPECT_TRUE(std::is_sorted(rows.begin(), rows.end()));
  EXPECT_EQ(ThinnedRows({a, b}, 10000).size(), 10000u);
}

TEST(RoundAxis, TicksAreRoundWithinTheEndsAndFarEnoughApart) {
  for (const auto& [low, high] : {std::pair{-0.047, 0.061}, std::pair{0.0, 14.98},
                                  std::pair{3.2e-5, 9.1e-5}, std::pair{-1234.0, 56789.0}}) {
    const PlacedAxis axis = RoundAxis(low, high, 70.0, 10.0);
    ASSERT_GE(axis.ticks.size(), 2u) << low;
    for (std::size_t i = 0; i < axis.ticks.size(); ++i) {
      EXPECT_GE(axis.ticks[i].first, low);
      EXPECT_LE(axis.ticks[i].first, high);
      EXPECT_NEAR(std::stod(axis.ticks[i].second), axis.ticks[i].first, 0.02 * (high - low));
      if (i > 0) {
        EXPECT_GE((axis.ticks[i].first - axis.ticks[i - 1].first) / (high - low) * 70.0, 9.999);
      }
    }
  }
}

// Liberation Sans at 8 pt, measured by pdftotext in a figure: 27.56 pt for this word.
TEST(TextWidth, IsTheFonts) { EXPECT_NEAR(TextWidthMm("position") / kMmPerPt, 27.56, 0.05); }

Figure SmallFigure() {
  Figure figure{.name = "small", .title = "A figure."};
  Panel panel{.x = {.label = "time [s]"}, .y = {.label = "error_x & more [%]"}};
  panel.series.push_back(
      LineSeries("line", "a line", LookOf(0), {0.0, 1.0, 2.0, 3.0}, {1.0, kNan, 3.0, 2.0}));
  panel.series.push_back(
      BandSeries("band", "a band", {.opacity = 0.3}, {0.0, 3.0}, {0.5, 0.5}, {1.5, 2.5}));
  panel.series.push_back(PointSeries("points", "points", LookOf(1), {1.0}, {2.0}));
  Series bars = BarSeries("bars", "bars", LookOf(2));
  AddBar(0.0, 0.5, 0.0, 1.0, &bars);
  panel.series.push_back(bars);
  Series texts = TextSeries("texts");
  AddText(2.0, 2.0, "100 %, more", &texts);
  panel.series.push_back(texts);
  figure.panels.push_back(panel);
  figure.sources = {"a record"};
  return figure;
}

TEST(FigureFiles, DataHoldEverySeriesAndNameTheRecords) {
  const FiguresFolder folder;
  const Figure figure = SmallFigure();
  WriteTextFile(folder / "small.csv", FigureCsv(figure));
  const FigureTable table = ReadFigureTable(folder / "small.csv");
  EXPECT_EQ(table.comments, (std::vector<std::string>{"A figure.", "from a record"}));
  ASSERT_EQ(table.heads.size(), 2u + 3 + 2 + 4 + 3);
  EXPECT_EQ(table.heads[0], "line: time [s]");
  EXPECT_EQ(table.heads[4], "band: error_x & more [%] to");
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_EQ(table.Column("line: time"), (std::vector<double>{0, 1, 2, 3}));
  EXPECT_EQ(table.rows[1][1], "nan");  // the gap
  EXPECT_EQ(table.Column("points: error_x"), std::vector<double>{2.0});
  EXPECT_EQ(table.rows[0].back(), "100 %; more");
  EXPECT_EQ(table.rows[1].back(), "-");
}

TEST(FigureLayout, PutsEveryTextOnThePage) {
  Figure figure = SmallFigure();
  for (int i = 0; i < 8; ++i) {
    figure.panels[0].series.push_back(
        LineSeries("more", "one more entry, number " + std::to_string(i), LookOf(0), {0.0}, {0.0}));
  }
  figure.notes = {"A note that is longer than the page is wide, so that it is broken into lines."};
  const FigureLayout layout = LayOut(figure);
  EXPECT_EQ(layout.width, kColumnWidthMm);
  EXPECT_EQ(layout.legend.size(), 4u + 8);
  double row = layout.height;
  double right = 0.0;
  for (const PlacedLegend& entry : layout.legend) {
    if (entry.y < row - 1e-9) right = 0.0;  // a new row
    EXPECT_GE(entry.x, right);
    row = entry.y;
    right = entry.x + kSampleMm + kSampleGapMm + TextWidthMm(entry.series->legend);
    EXPECT_LE(right, layout.width);
    EXPECT_GT(entry.y, layout.panels[0].bottom + layout.panels[0].height);
  }
  EXPECT_EQ(layout.notes.size(), 2u);
  for (const PlacedText& note : layout.notes) {
    EXPECT_LE(note.x + TextWidthMm(note.text), layout.width);
    EXPECT_GT(note.y, 0.0);
  }
  // Left of the frame: words, ticks, in this order and without touching.
  const PlacedPanel& panel = layout.panels[0];
  double ticks = 0.0;
  for (const auto& [value, text] : panel.y.ticks) ticks = std::max(ticks, TextWidthMm(text));
  for (const PlacedText& line : panel.y_label) {
    EXPECT_GT(line.x - 0.5 * kLineHeightMm, 0.0);
    EXPECT_LT(line.x + 0.5 * kLineHeightMm, panel.left - ticks);
  }
}

TEST(Pgfplots, EscapesWhatTexTakesForItsOwn) {
  const Figure figure = SmallFigure();
  const std::string tex = PgfplotsDocument(figure, LayOut(figure));
  EXPECT_NE(tex.find("error\\_x \\& more [\\%]"), std::string::npos);
  EXPECT_NE(tex.find("{small.csv}"), std::string::npos);
}

}  // namespace
}  // namespace duet
