#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "experiments/calibration_watch.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/figures/run_errors.h"

namespace duet {
namespace {

constexpr std::size_t kMostComponents = 6;
/// Where the prior is this many times as wide as what is known after the first tenth of the time,
/// an axis that held it would show nothing else.
constexpr double kTooWide = 3.0;
constexpr double kBeginning = 0.1;
constexpr double kDegreesPerRadian = 180.0 / 3.14159265358979323846;

/// How a number of the calibration is shown.
struct Unit {
  const char* name;
  double factor;
};

Unit UnitOf(const std::string& component) {
  const auto has = [&](const char* part) { return component.find(part) != std::string::npos; };
  if (component == "t_d" || component == "t_r") return {"ms", 1e3};
  if (has("p_CB")) return {"mm", 1e3};
  if (has("R_CB")) return {"deg", kDegreesPerRadian};
  for (const char* pixels : {".fx", ".fy", ".ox", ".oy"}) {
    if (has(pixels)) return {"px", 1.0};
  }
  return {component.rfind("T_s", 0) == 0 ? "rad/s per m/s²" : "-", 1.0};
}

/// A number over time, and its standard deviation.
struct Course {
  std::string component;  ///< its name without the unit
  std::size_t value = 0;  ///< columns of the table
  std::size_t sigma = 0;
};

// Those of the columns with a standard deviation that belong to the calibration.
std::vector<Course> EstimatedCourses(const RecordTable& states) {
  std::vector<Course> courses;
  for (std::size_t i = 0; i < states.names.size(); ++i) {
    const std::string& name = states.names[i];
    if (name.starts_with("b_g_") || name.starts_with("b_a_")) continue;
    const auto sigma = std::find(states.names.begin(), states.names.end(), "sigma_" + name);
    if (sigma == states.names.end()) continue;
    courses.push_back({name.substr(0, name.find(" [")), i,
                       static_cast<std::size_t>(sigma - states.names.begin())});
  }
  return courses;
}

const Course* FindCourse(const std::vector<Course>& courses, const std::string& component) {
  for (const Course& course : courses) {
    if (course.component == component) return &course;
  }
  return nullptr;
}

std::vector<std::string> EstimatedComponents(const RecordTable& states) {
  std::vector<std::string> names;
  for (const Course& course : EstimatedCourses(states)) names.push_back(course.component);
  return names;
}

// The times, then the first number of each block, as far as they go.
std::vector<std::string> ChosenComponents(const std::vector<std::string>& estimated,
                                          const std::vector<std::string>& asked,
                                          const std::string& file) {
  if (estimated.empty()) {
    throw InputError(file, 0, "",
                     "holds no calibration; expected a run that estimates one, e.g. with --set "
                     "shared.calibration.t_d.state=estimated");
  }
  for (const std::string& name : asked) {
    if (std::find(estimated.begin(), estimated.end(), name) == estimated.end()) {
      throw InputError("", 0, "--component",
                       "'" + name + "' is not estimated" + DidYouMean(name, estimated));
    }
  }
  if (!asked.empty()) return asked;
  std::vector<std::string> chosen;
  for (const char* name :
       {"t_d", "t_r", "cam0.p_CB.x", "cam0.R_CB.x", "cam0.fx", "T_g.11", "T_a.11"}) {
    if (chosen.size() < kMostComponents &&
        std::find(estimated.begin(), estimated.end(), name) != estimated.end()) {
      chosen.emplace_back(name);
    }
  }
  for (const std::string& name : estimated) {
    if (chosen.empty()) chosen.push_back(name);
  }
  return chosen;
}

/// What an axis has to hold: everything, and what there is after the beginning.
struct Reach {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  void Include(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

// Ends an axis where the band is once the beginning is over; true where it has been.
bool EndAfterBeginning(const Reach& whole, const Reach& later, Axis* axis) {
  const double width = later.high - later.low;
  if (!(width > 0.0) || !(whole.high - whole.low > kTooWide * width)) return false;
  axis->low = later.low - 0.1 * width;
  axis->high = later.high + 0.1 * width;
  return true;
}

// calibration_truth.csv of a study's record: `name,true`.
std::map<std::string, double> TrueCalibration(const FigureRun& run) {
  std::map<std::string, double> truth;
  const std::filesystem::path file = run.folder / "calibration_truth.csv";
  if (!std::filesystem::exists(file)) return truth;
  const std::string csv = ReadTextFile(file);
  std::size_t begin = 0;
  for (int line = 1; begin < csv.size(); ++line) {
    const std::size_t end = std::min(csv.find('\n', begin), csv.size());
    const std::string row = csv.substr(begin, end - begin);
    begin = end + 1;
    if (row.empty() || row[0] == '#' || row.rfind("name", 0) == 0) continue;
    const std::size_t comma = row.find(',');
    const std::optional<double> value =
        comma == std::string::npos ? std::nullopt : ParseDouble(row.substr(comma + 1));
    if (!value) throw InputError(file, line, "", "expected a name and a number");
    truth[row.substr(0, comma)] = *value;
  }
  return truth;
}

std::map<std::string, double> ToldCalibration(const FigureRun& run) {
  std::map<std::string, double> told;
  const std::filesystem::path file = run.folder / "calibration.csv";
  if (!std::filesystem::exists(file)) return told;
  for (const CalibrationWatch::Number& number : ReadCalibrationCsv(ReadTextFile(file), file)) {
    told[number.name] = number.told;
  }
  return told;
}

// The runs from the first on that estimates what is asked for (anything, where nothing is), so that
// a study whose baseline estimates nothing has its figure; all of them where none does.
std::vector<FigureRun> FromFirstEstimating(const std::vector<FigureRun>& all,
                                           const std::vector<std::string>& asked) {
  std::set<std::string> seen;
  for (auto run = all.begin(); run != all.end(); ++run) {
    const StudyRun& where = run->where;
    // Seeds of a setting estimate the same.
    const std::string group =
        where.stream + "\n" + where.estimator + "\n" + where.setting + "\n" + where.perturbation;
    if (!run->has_record() || !seen.insert(group).second) continue;
    const std::vector<std::string> estimated =
        EstimatedComponents(ReadRecordTable(run->folder / "states.csv"));
    const bool has_all = std::all_of(asked.begin(), asked.end(), [&](const std::string& name) {
      return std::find(estimated.begin(), estimated.end(), name) != estimated.end();
    });
    if (!estimated.empty() && has_all) return {run, all.end()};
  }
  return asked.empty() ? all : FromFirstEstimating(all, {});
}

}  // namespace

Figure CalibrationFigure(const FigureInput& input) {
  const FoundRuns all = FindRuns(input);
  FoundRuns estimating = all;
  estimating.chosen = FromFirstEstimating(all.chosen, input.components);
  const std::vector<FigureRun> runs = ExampleRuns(estimating);
  std::vector<RecordTable> states;
  for (const FigureRun& run : runs) states.push_back(ReadRecordTable(run.folder / "states.csv"));
  const std::vector<std::string> components = ChosenComponents(
      EstimatedComponents(states.front()), input.components, runs.front().folder / "states.csv");

  Figure figure;
  figure.sources = DescribeSources(runs);
  Timestamp start = 0;
  for (const RecordTable& table : states) {
    if (table.stamps.empty()) continue;
    start = start == 0 ? table.stamps.front() : std::min(start, table.stamps.front());
  }
  const std::vector<Look> looks = LooksOf(runs);
  bool truth_known = false;
  double longest_s = 0.0;
  for (const RecordTable& table : states) {
    if (!table.stamps.empty()) {
      longest_s = std::max(longest_s, SecondsBetween(start, table.stamps.back()));
    }
  }
  bool beginning_left_out = false;
  for (const std::string& component : components) {
    const Unit unit = UnitOf(component);
    Panel panel{.x = {.label = "time after the first state [s]"},
                .y = {.label = component + " [" + unit.name + "]"},
                .height_mm = components.size() > 3 ? 21.0 : 28.0,
                .share_x = component != components.back()};
    Reach whole, later;
    for (std::size_t n = 0; n < runs.size(); ++n) {
      const std::vector<Course> courses = EstimatedCourses(states[n]);
      const Course* course = FindCourse(courses, component);
      if (course == nullptr || states[n].stamps.empty()) continue;
      const std::vector<double>* values = &states[n].columns[course->value];
      const std::vector<double>* sigmas = &states[n].columns[course->sigma];
      std::vector<double> t_s, value, low, high;
      for (std::size_t i = 0; i < values->size(); ++i) {
        t_s.push_back(SecondsBetween(start, states[n].stamps[i]));
        value.push_back((*values)[i] * unit.factor);
        low.push_back(((*values)[i] - 3.0 * (*sigmas)[i]) * unit.factor);
        high.push_back(((*values)[i] + 3.0 * (*sigmas)[i]) * unit.factor);
        for (const double end : {low.back(), high.back()}) {
          whole.Include(end);
          if (t_s.back() >= kBeginning * longest_s) later.Include(end);
        }
      }
      const std::vector<double> span = {t_s.front(), t_s.back()};
      const Look look = looks[n];
      Look sigma_look = SigmaLook(look);
      sigma_look.dash = look.dash == kSolid ? kSolid : kShortDashed;
      // The reference is the first run's: the same for all on one stream.
      if (n == 0) {
        const std::map<std::string, double> truth = TrueCalibration(runs[n]);
        const std::map<std::string, double> told = ToldCalibration(runs[n]);
        const auto add = [&](const std::map<std::string, double>& from, const char* name,
                             const Look& how) {
          const auto found = from.find(component);
          if (found == from.end()) return false;
          const double level = found->second * unit.factor;
          whole.Include(level);
          later.Include(level);
          panel.series.push_back(LineSeries(name, name, how, span, {level, level}));
          return true;
        };
        truth_known = add(truth, "truth", TruthLook()) || truth_known;
        (void)add(told, "told", {.colour = kGrey, .dash = kDotted, .width_pt = 0.8});
      }
      const std::string& label = runs[n].label;
      panel.series.push_back(LineSeries(label, label, look, t_s, value));
      panel.series.push_back(
          LineSeries(label + " -3 sigma", label + ", ±3σ", sigma_look, t_s, low));
      panel.series.push_back(LineSeries(label + " +3 sigma", "", sigma_look, t_s, high));
    }
    beginning_left_out = EndAfterBeginning(whole, later, &panel.y) || beginning_left_out;
    figure.panels.push_back(std::move(panel));
  }
  if (beginning_left_out) {
    figure.notes.push_back("In the first " +
                           FormatNumber(std::round(10.0 * kBeginning * longest_s) / 10.0) +
                           " s lines go beyond the axes: the priors are wider.");
  }
  if (!truth_known) {
    figure.notes.push_back("The records hold no true calibration (calibration_truth.csv).");
  }
  AddNote(FailedNote(runs, "drawn as far as it went"), &figure);
  AddNote(DrawnNote(all, runs), &figure);
  return figure;
}

}  // namespace duet
