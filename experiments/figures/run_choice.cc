#include "experiments/figures/run_choice.h"

#include <algorithm>
#include <iterator>
#include <set>

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "common/support/numeric_text.h"
#include "experiments/figures/figure_runs.h"

namespace duet {
namespace {

InputError FlagError(const RunCoordinate& coordinate, const std::string& text) {
  return InputError("", 0, std::string("--") + coordinate.name, text);
}

bool Is(const RunCoordinate& coordinate, const char* name) {
  return std::string(name) == coordinate.name;
}

bool DependsOn(DrawnRuns drawn, const RunCoordinate& coordinate) {
  if (drawn == DrawnRuns::kNone) return false;
  return drawn != DrawnRuns::kOneStream || Is(coordinate, "stream") || Is(coordinate, "seed");
}

bool DrawsSeveral(DrawnRuns drawn, const RunCoordinate& coordinate) {
  if (Is(coordinate, "estimator")) {
    return drawn != DrawnRuns::kOneRun && drawn != DrawnRuns::kOneStream;
  }
  const bool settings = drawn == DrawnRuns::kOverSettings;
  if (Is(coordinate, "seed")) return settings || drawn == DrawnRuns::kOverSeeds;
  return settings && Is(coordinate, "setting");
}

bool Has(const FigureRun& run, const RunCoordinate& coordinate) {
  return (coordinate.of_plain_runs || !run.study.empty()) && !coordinate.value(run.where).empty();
}

bool HasValue(const FigureRun& run, const RunCoordinate& coordinate, const std::string& value) {
  return Has(run, coordinate) && coordinate.value(run.where) == value;
}

// Where an unknown name was meant to be.
std::string KnownInstead(const RunCoordinate& coordinate, const std::string& name,
                         const std::vector<std::string>& known) {
  if (Is(coordinate, "seed")) {  // one number is as near as another
    const auto smaller = [](const std::string& a, const std::string& b) {
      return ParseInt64(a).value_or(0) < ParseInt64(b).value_or(0);
    };
    const auto [least, most] = std::minmax_element(known.begin(), known.end(), smaller);
    return "; the seeds are " + *least + (*least == *most ? "" : " to " + *most);
  }
  std::string meant = DidYouMean(name, known);
  if (!meant.empty()) return meant;
  constexpr std::size_t kMostNamed = 8;
  std::string names;
  for (std::size_t i = 0; i < std::min(known.size(), kMostNamed); ++i) {
    names += (i == 0 ? "" : ", ") + known[i];
  }
  return "; expected " + names + (known.size() > kMostNamed ? ", ..." : "");
}

void RequireKnown(const std::vector<FigureRun>& found, const RunCoordinate& coordinate,
                  const std::vector<std::string>& names) {
  std::vector<std::string> known;
  for (const FigureRun& run : found) {
    if (!Has(run, coordinate)) continue;
    const std::string value = coordinate.value(run.where);
    if (std::find(known.begin(), known.end(), value) == known.end()) known.push_back(value);
  }
  if (known.empty()) {
    throw FlagError(coordinate, std::string("the runs have no ") + coordinate.name +
                                    (coordinate.of_plain_runs
                                         ? " in their manifest.json"
                                         : ": they are of duet run or duet compare, not of a "
                                           "study; expected no such choice"));
  }
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw FlagError(coordinate, "no run is of " + std::string(coordinate.name) + " '" + name + "'" +
                                    KnownInstead(coordinate, name, known));
  }
}

}  // namespace

const std::array<RunCoordinate, 5>& RunCoordinates() {
  static constexpr std::array<RunCoordinate, 5> coordinates = {
      RunCoordinate{"stream", [](const StudyRun& where) { return where.stream; },
                    &RunChoice::streams, "", true},
      RunCoordinate{"setting", [](const StudyRun& where) { return where.setting; },
                    &RunChoice::settings, "default", false},
      RunCoordinate{"perturbation", [](const StudyRun& where) { return where.perturbation; },
                    &RunChoice::perturbations, "none", false},
      RunCoordinate{"seed", [](const StudyRun& where) { return std::to_string(where.seed); },
                    &RunChoice::seeds, "", false},
      RunCoordinate{"estimator", [](const StudyRun& where) { return where.estimator; },
                    &RunChoice::estimators, "", true}};
  return coordinates;
}

void RequireEffect(const RunChoice& choice, const std::string& figure, DrawnRuns drawn) {
  for (const RunCoordinate& coordinate : RunCoordinates()) {
    const std::vector<std::string>& names = choice.*coordinate.chosen;
    if (names.empty()) continue;
    const std::string name = coordinate.name;
    if (drawn == DrawnRuns::kNone) {
      throw FlagError(coordinate,
                      "has no effect on duet figure " + figure + ", which is not made of runs");
    }
    if (!DependsOn(drawn, coordinate)) {
      throw FlagError(coordinate, "has no effect on duet figure " + figure +
                                      ", which shows the data that every " + name + " was given");
    }
    if (names.size() > 1 && !DrawsSeveral(drawn, coordinate)) {
      throw FlagError(coordinate,
                      "stands there twice, and duet figure " + figure + " draws one " + name);
    }
    for (std::size_t i = 1; i < names.size(); ++i) {
      const auto end = names.begin() + static_cast<std::ptrdiff_t>(i);
      if (std::find(names.begin(), end, names[i]) == end) continue;
      throw FlagError(coordinate, "'" + names[i] + "' stands there twice");
    }
  }
}

void RequireNoChoice(const RunChoice& choice, const std::string& what) {
  for (const RunCoordinate& coordinate : RunCoordinates()) {
    if ((choice.*coordinate.chosen).empty()) continue;
    throw FlagError(coordinate, "chooses among runs, and the figure is made of " + what);
  }
}

std::vector<FigureRun> ChosenRuns(const std::vector<FigureRun>& found, const RunChoice& choice) {
  std::vector<FigureRun> chosen = found;
  std::string together;
  for (const RunCoordinate& coordinate : RunCoordinates()) {
    const std::vector<std::string>& names = choice.*coordinate.chosen;
    if (names.empty()) continue;
    RequireKnown(found, coordinate, names);
    std::erase_if(chosen, [&](const FigureRun& run) {
      return std::none_of(names.begin(), names.end(),
                          [&](const std::string& name) { return HasValue(run, coordinate, name); });
    });
    for (const std::string& name : names) {
      together += (together.empty() ? "--" : " --") + std::string(coordinate.name) + " " + name;
    }
  }
  if (std::none_of(chosen.begin(), chosen.end(),
                   [](const FigureRun& run) { return run.has_record(); })) {
    throw InputError(together + (chosen.empty() ? ": no run is of all of these"
                                                : ": no such run left a record"));
  }
  RequireEachChosen(chosen, choice);
  return chosen;
}

void RequireEachChosen(const std::vector<FigureRun>& drawn, const RunChoice& choice) {
  for (const RunCoordinate& coordinate : RunCoordinates()) {
    for (const std::string& name : choice.*coordinate.chosen) {
      if (std::any_of(drawn.begin(), drawn.end(),
                      [&](const FigureRun& run) { return HasValue(run, coordinate, name); })) {
        continue;
      }
      throw FlagError(coordinate, "'" + name +
                                      "' has no run that is drawn with the other runs "
                                      "chosen; leave it out, or choose more closely");
    }
  }
}

}  // namespace duet
