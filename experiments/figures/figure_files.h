#pragma once

#include <filesystem>
#include <string>

#include "experiments/figures/figure.h"
#include "experiments/figures/figure_layout.h"

namespace duet {

/// The data of a figure, NAME.csv: comments that name the records, a line of column heads (after a
/// '#'), then rows. Each series has columns of its own, one beside the other, the shorter ones
/// filled up with "nan" ("-" for texts); `nan` within a series is a gap.
[[nodiscard]] std::string FigureCsv(const Figure& figure);

/// NAME.gp: a gnuplot script that, in its folder, draws NAME.csv as NAME.svg, .pdf and .png.
[[nodiscard]] std::string GnuplotScript(const Figure& figure, const FigureLayout& layout);

/// NAME.tex: the same by PGFPlots, which reads NAME.csv. To be \input in a paper that loads
/// pgfplots (in whose fonts it is then) or compiled as it is.
[[nodiscard]] std::string PgfplotsDocument(const Figure& figure, const FigureLayout& layout);

/// The first column of each series in the data, in the order of the panels.
struct SeriesColumns {
  const Series* series;
  std::size_t panel;
  int first;  ///< counted from 0
  std::size_t rows;
};
[[nodiscard]] std::vector<SeriesColumns> ColumnsOf(const Figure& figure);

/// Writes all of them into `folder`, which is made where it is absent, complete or not at all, and
/// draws the figure. Files of the same names are replaced. False where gnuplot is not installed:
/// the script is there to be run elsewhere. Throws OutputError.
[[nodiscard]] bool WriteFigure(const Figure& figure, const std::filesystem::path& folder);

}  // namespace duet
