#include <gflags/gflags.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/figures/figures.h"

DEFINE_string(figure_runs, "",
              "A folder with run records: of duet study, duet compare or duet run (or what the "
              "figure's line names); further folders may follow without the flag.");
DEFINE_string(figure_out, "", "Folder to write into; made where it is absent.");
DEFINE_string(component, "",
              "duet figure calibration: a number of the calibration to draw, by its name in "
              "states.csv. Without: one of each block.");
DEFINE_string(figure_stream, "",
              "Draws this stream of a study; of records that are of none, the recording of this "
              "name. Without: the first.");
DEFINE_string(
    figure_setting, "",
    "Draws this setting of a study. Without: the first; duet figure cost_against_accuracy "
    "draws all or those given.");
DEFINE_string(figure_perturbation, "", "Draws this perturbation of a study. Without: the first.");
DEFINE_string(figure_seed, "",
              "Draws this seed of a study. Without: the first; statistics over runs take all or "
              "those given.");
DEFINE_string(figure_estimator, "", "Draws this estimator's runs. Without: all of them.");

namespace duet {
namespace {

// As RunChoice has them: whole numbers without zeros before them.
std::vector<std::string> SeedsOf(const CommandLine& line) {
  std::vector<std::string> seeds;
  for (const std::string& text : line.All("seed")) {
    const std::optional<std::int64_t> seed = ParseInt64(text);
    if (!seed) throw InputError("", 0, "--seed", "'" + text + "' is no whole number");
    seeds.push_back(std::to_string(*seed));
  }
  return seeds;
}

std::string FigureList() {
  std::string text;
  for (const FigureName& figure : FigureNames()) {
    text += "  " + figure.name;
    text.append(figure.name.size() < 20 ? 20 - figure.name.size() : 1, ' ');
    text += figure.summary + "\n";
  }
  return text;
}

FlagUse ChoiceFlag(const std::string& name, const std::string& value, bool repeatable) {
  return {.name = name, .value = value, .repeatable = repeatable, .variable = "figure_" + name};
}

int RunFigure(const CommandLine& line) {
  std::vector<std::string> words = line.operands();
  if (words.empty()) throw InputError("expected a figure's name; duet figure list names them");
  const std::string name = words.front();
  if (name == "list") {
    std::fputs(FigureList().c_str(), stdout);
    return kDone;
  }
  if (FLAGS_figure_out.empty()) throw InputError("", 0, "--out", "is missing; expected a folder");
  FigureInput input;
  for (const std::string& folder : line.All("runs")) input.folders.emplace_back(folder);
  input.folders.insert(input.folders.end(), words.begin() + 1, words.end());
  input.components = line.All("component");
  if (!input.components.empty() && name != "calibration") {
    throw InputError("", 0, "--component", "is of duet figure calibration alone");
  }
  input.choice = {.streams = line.All("stream"),
                  .settings = line.All("setting"),
                  .perturbations = line.All("perturbation"),
                  .seeds = SeedsOf(line),
                  .estimators = line.All("estimator")};
  for (const std::filesystem::path& folder : input.folders) {
    if (!std::filesystem::exists(folder)) {
      throw InputError(folder, 0, "", "does not exist; expected a folder with run records");
    }
  }
  const std::filesystem::path out = FLAGS_figure_out;
  const std::filesystem::path data = out / (name + ".csv");
  std::error_code ignored;
  if (std::filesystem::exists(data, ignored)) {
    throw InputError(data, 0, "", "exists; --out expects a folder without this figure");
  }
  const bool drawn = MakeFigure(name, input, out);
  std::printf("%s%s in %s\n", name.c_str(),
              drawn ? ".csv, .gp, .svg, .pdf, .png and .tex" : ".csv, .gp and .tex", out.c_str());
  if (!drawn) {
    std::fprintf(stderr,
                 "duet: gnuplot is not installed; run 'gnuplot %s.gp' there to draw the figure\n",
                 name.c_str());
  }
  return kDone;
}

}  // namespace

Command FigureCommand() {
  return {.name = "figure",
          .summary = "Makes a figure for a paper from run records.",
          .description =
              "Writes NAME.csv (the data, with the records that it came from), NAME.gp (gnuplot), "
              "NAME.svg, NAME.pdf and NAME.png, and NAME.tex (PGFPlots, in the paper's own fonts) "
              "into --out; several figures can share a folder. A column wide (88.9 mm), letters of "
              "8 pt. What is shown over time is one example, statistics are over the runs of one "
              "setting: the first found, or what --stream, --setting, --perturbation, --seed and "
              "--estimator choose; a choice that a figure does not have is refused.",
          .example = "duet figure position_error --runs compare-mh01 --out figures",
          .flags = {{.name = "runs", .value = "DIR", .repeatable = true, .variable = "figure_runs"},
                    {.name = "out", .value = "DIR", .variable = "figure_out"},
                    {.name = "component", .value = "NAME", .repeatable = true},
                    ChoiceFlag("stream", "NAME", false),
                    ChoiceFlag("setting", "NAME", true),
                    ChoiceFlag("perturbation", "NAME", false),
                    ChoiceFlag("seed", "N", true),
                    ChoiceFlag("estimator", "NAME", true)},
          .operands = "NAME [DIR...] | list",
          .table = "Figures\n" + FigureList(),
          .run = RunFigure};
}

}  // namespace duet
