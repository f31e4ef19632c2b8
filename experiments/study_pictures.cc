#include "experiments/study_pictures.h"

#include <algorithm>
#include <filesystem>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "experiments/figures/figure_files.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figures.h"
#include "experiments/progress.h"
#include "experiments/report/report.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr const char* kReport = "report.html";

/// Of a study that names none; those that its records do not hold are left out.
const std::vector<std::string>& DefaultFigures() {
  static const std::vector<std::string> names = {"trajectory_top", "rmse_over_runs",
                                                 "position_error", "nees_over_time"};
  return names;
}

const std::vector<std::string>& FiguresOf(const StudyFile& study) {
  return study.figures ? *study.figures : DefaultFigures();
}

}  // namespace

void CheckFigures(const StudyFile& study) {
  std::vector<std::string> known;
  for (const FigureName& figure : FigureNames()) known.push_back(figure.name);
  for (const std::string& name : FiguresOf(study)) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError(study.file, 0, "figures",
                     "no figure is called '" + name + "'" + DidYouMean(name, known));
  }
}

std::vector<std::string> MakePictures(const StudyFolder& folder) {
  std::vector<std::string> made;
  for (const std::string& name : FiguresOf(folder.study)) {
    try {
      (void)MakeFigure(name, {.folders = {folder.path}}, folder.path / "figures");
    } catch (const InputError& error) {
      if (folder.study.figures) PrintWarning("figure " + name + ": " + error.what());
      continue;
    }
    for (const char* ending : {".csv", ".gp", ".tex", ".svg", ".pdf", ".png"}) {
      const std::string file = "figures/" + name + ending;
      if (fs::exists(folder.path / file)) made.push_back(file);
    }
  }
  (void)WriteReport(folder.path, folder.path / kReport);
  made.emplace_back(kReport);
  return made;
}

std::vector<std::pair<std::string, std::string>> PictureTexts(const StudyFolder& folder) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (const std::string& name : FiguresOf(folder.study)) {
    try {
      const Figure figure = ComposeFigure(name, {.folders = {folder.path}});
      texts.emplace_back("figures/" + name + ".csv", FigureCsv(figure));
    } catch (const InputError&) {  // the study's command could not make it either
    }
  }
  texts.emplace_back(kReport, ReportPage(ReadReport(folder.path)));
  return texts;
}

}  // namespace duet
