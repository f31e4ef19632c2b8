#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "common/support/text_file.h"
#include "evaluation/study_table.h"

namespace duet {
namespace {

/// Everything that a name or a reason may hold, in every place where it may stand.
StudyTable HardTable() {
  const std::string hard = R"([a]_b % $x$ & #1 ~ ^ \ { } < > | "q", 'p' *s* `c`)";
  StudyTable table;
  table.name = "hard_table";
  table.title = hard;
  table.columns = {{.title = "stream", .is_text = true},
                   {.title = "median", .unit = "m", .group = "msckf", .spread = "quartiles"},
                   {.title = "failed", .group = "msckf"},
                   {.title = "median", .unit = "m", .group = hard, .spread = "quartiles"},
                   {.title = "why", .is_text = true}};
  const auto text = [](const std::string& t) {
    TableCell cell;
    cell.text = t;
    cell.is_blank = true;
    return cell;
  };
  TableCell best;
  best.value = 0.125;
  best.low = 0.0625;
  best.high = 1.0 / 3.0;
  best.decimals = 4;
  best.mark = TableMark::kBest;
  TableCell second;
  second.value = 1e-7;
  second.mark = TableMark::kSecondBest;
  table.rows.push_back({.section = hard, .cells = {}});
  table.rows.push_back(
      {.section = "", .cells = {text(hard), best, text("1/20"), second, text("")}});
  table.rows.push_back({.section = "", .cells = {text("[b]"), second, {}, best, text(hard)}});
  table.verdict = hard;
  table.foot = {hard, "line\nbreak"};
  return table;
}

TEST(TableRendering, TerminalIsAligned) {
  StudyTable table = HardTable();
  table.title = "T";
  table.rows.erase(table.rows.begin());
  table.rows[0].cells[0].text = "r\xc3\xb6om";  // four characters, five bytes
  table.rows[1].cells[4].text = "z";
  table.columns[3].group = "window";
  table.verdict = "V.";
  table.foot = {"foot"};
  EXPECT_EQ(TableText(table),
            "T\n"
            "\n"
            "                                    msckf                     window\n"
            "stream                 median [m]  failed                 median [m]  why\n"
            "-------------------------------------------------------------------------\n"
            "r\xc3\xb6om    0.1250 [0.0625, 0.3333] *    1/20                    0.000 +\n"
            "[b]                       0.000 +       -  0.1250 [0.0625, 0.3333] *  z\n"
            "\n"
            "V.\n"
            "\n"
            "* best, + second\n"
            "foot\n");
}

TEST(TableRendering, CsvHasFullPrecisionAndQuotesWhatItMust) {
  StudyTable table = HardTable();
  const std::string csv = TableCsv(table);
  EXPECT_THAT(csv,
              testing::HasSubstr(",0.125,0.0625,0.3333333333333333,best,1/20,1e-07,,,second,"));
  EXPECT_THAT(csv, testing::HasSubstr("# line\n# break\n"));
  EXPECT_THAT(csv, testing::HasSubstr(R"("[a]_b % $x$ & #1 ~ ^ \ { } < > | ""q"", 'p' *s* `c`")"));
}

TEST(TableRendering, MarkdownShowsTextAndNotMarkup) {
  const std::string text = TableMarkdown(HardTable());
  EXPECT_THAT(text, testing::HasSubstr(R"(\[a\]\_b % $x$ & \#1 \~ ^ \\ { } \< \> \| "q")"));
  EXPECT_THAT(text, testing::HasSubstr("| **0.1250 \\[0.0625, 0.3333\\]** | 1/20 | *0.000* |"));
  // Rows of as many cells as there are columns.
  std::size_t at = text.find("\n|");
  int rows = 0;
  while (at != std::string::npos) {
    const std::string line = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
    int bars = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      if (line[i] == '|' && (i == 0 || line[i - 1] != '\\')) ++bars;
    }
    EXPECT_EQ(bars, 6) << line;
    ++rows;
    at = text.find("\n|", at + 1);
  }
  EXPECT_EQ(rows, 5);
}

TEST(TableRendering, LatexHasMinusSignsInNumbersOnly) {
  StudyTable table;
  table.name = "t";
  table.columns = {{.title = "a", .is_text = true}, {.title = "b", .spread = "quartiles"}};
  table.rows.resize(1);
  table.rows[0].cells.resize(2);
  table.rows[0].cells[0].text = "run-3";
  table.rows[0].cells[1] = {.text = "", .value = -0.5, .low = -1.0, .high = 2.0, .decimals = 1};
  EXPECT_THAT(TableLatex(table), testing::HasSubstr("run-3 & $-$0.5 [$-$1.0, 2.0] \\\\"));
}

TEST(TableRendering, LatexCompiles) {
  if (std::system("pdflatex --version > /dev/null 2>&1 && kpsewhich booktabs.sty > /dev/null") !=
      0) {
    GTEST_SKIP() << "no pdflatex with booktabs (texlive-latex-base, texlive-latex-recommended): "
                    "the LaTeX tables are not checked";
  }
  const auto folder = std::filesystem::temp_directory_path() /
                      ("duet_table_rendering_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  WriteTextFile(folder / "table.tex", TableLatex(HardTable()));
  WriteTextFile(folder / "paper.tex",
                "\\documentclass{article}\n\\usepackage{booktabs,graphicx}\n"
                "\\begin{document}\n\\input{table}\n\\end{document}\n");
  const std::string command = "cd '" + folder.string() +
                              "' && pdflatex -interaction=nonstopmode -halt-on-error paper.tex "
                              "> output.txt 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0) << ReadTextFile(folder / "output.txt");
  const std::string log = ReadTextFile(folder / "paper.log");
  EXPECT_THAT(log, testing::Not(testing::HasSubstr("Missing character")));
  EXPECT_THAT(log, testing::Not(testing::HasSubstr("Overfull")));
  EXPECT_THAT(log, testing::HasSubstr("Output written on paper.pdf (1 page"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace duet
