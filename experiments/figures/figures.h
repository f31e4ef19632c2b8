#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/figures/run_choice.h"

namespace duet {

/// What figures are made from: folders with run records (of a study, of `duet compare`, of `duet
/// run`), or what the figure's summary names instead.
struct FigureInput {
  std::vector<std::filesystem::path> folders;
  /// calibration: the components to draw (names as in states.csv); empty: one of each block.
  std::vector<std::string> components = {};
  /// Of the runs in `folders`; a name that could not change the figure is refused.
  RunChoice choice = {};
};

struct FigureName {
  std::string name;
  std::string summary;  ///< one line: what it shows and, where these are no run records, from what
};

/// All figures, in the order of docs/figures.md.
[[nodiscard]] std::vector<FigureName> FigureNames();

/// Makes a figure from records alone and writes it into `out` (which is made where it is absent) as
/// NAME.csv (data; names the records), NAME.gp, NAME.tex and, where gnuplot is installed, NAME.svg,
/// NAME.pdf and NAME.png; files of these names are replaced. False where gnuplot is not installed.
/// Throws InputError for an unknown name (naming the nearest), for a choice of runs that the figure
/// does not have or that leaves none, and for input that does not hold what it shows, OutputError
/// where writing fails.
bool MakeFigure(const std::string& name, const FigureInput& input,
                const std::filesystem::path& out);

}  // namespace duet
