#include "experiments/figures/figure_files.h"

#include <system_error>

#include "common/support/input_error.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"
#include "experiments/gnuplot.h"

namespace duet {
namespace fs = std::filesystem;

bool WriteFigure(const Figure& figure, const fs::path& folder) {
  const FigureLayout layout = LayOut(figure);
  const OutputFolder made(folder / ("." + figure.name));
  const std::string script = figure.name + ".gp";
  WriteTextFile(made.path() / (figure.name + ".csv"), FigureCsv(figure));
  WriteTextFile(made.path() / script, GnuplotScript(figure, layout));
  WriteTextFile(made.path() / (figure.name + ".tex"), PgfplotsDocument(figure, layout));
  const bool drawn = RunGnuplot(made.path(), script);
  for (const char* ending : {".gp", ".svg", ".pdf", ".png", ".tex", ".csv"}) {
    const std::string file = figure.name + ending;
    std::error_code error;
    if (!fs::exists(made.path() / file, error)) {
      fs::remove(folder / file, error);  // of an earlier figure, which this one replaces
      continue;
    }
    fs::rename(made.path() / file, folder / file, error);
    if (error) throw OutputError(folder / file, error.message());
  }
  return drawn;
}

}  // namespace duet
