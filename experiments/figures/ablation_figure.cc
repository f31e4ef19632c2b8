#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>

#include "common/support/input_error.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"

namespace duet {
namespace {

constexpr std::size_t kMostVariants = 32;

/// One colour of the matrix: ratios up to `below`.
struct Level {
  double below;
  const char* legend;
  Look look;
};

const std::vector<Level>& Levels() {
  static const std::vector<Level> levels = {
      {0.5, "under 0.5 of none", {.colour = kBlue, .opacity = 0.55}},
      {0.8, "0.5 to 0.8", {.colour = kSkyBlue, .opacity = 0.45}},
      {1.25, "0.8 to 1.25", {.colour = kGrey, .opacity = 0.12}},
      {2.0, "1.25 to 2", {.colour = kOrange, .opacity = 0.4}},
      {INFINITY, "over 2", {.colour = kVermilion, .opacity = 0.65}}};
  return levels;
}

/// What a panel shows of a cell of the ablation; nothing where it has none.
struct Quantity {
  const char* title;
  std::optional<double> (*of)(const nlohmann::ordered_json& cell);
  double aim = 0.0;  ///< what is best; 0: the smaller the better
};

std::optional<double> NumberAt(const nlohmann::ordered_json& cell, const char* group,
                               const char* key) {
  const auto found = cell.find(group);
  if (found == cell.end() || !found->contains(key) || !found->at(key).is_number()) {
    return std::nullopt;
  }
  return found->at(key).get<double>();
}

const std::vector<Quantity>& Quantities() {
  static const std::vector<Quantity> quantities = {
      {"position error [m], median of ATE",
       [](const nlohmann::ordered_json& cell) {
         return NumberAt(cell, "ate_position_m", "median");
       }},
      {"orientation error [deg], median of ATE",
       [](const nlohmann::ordered_json& cell) {
         return NumberAt(cell, "ate_orientation_deg", "median");
       }},
      {"pose NEES, mean [-], expected 6",
       [](const nlohmann::ordered_json& cell) { return NumberAt(cell, "pose_nees", "mean"); }, 6.0},
      {"time a frame [ms], median",
       [](const nlohmann::ordered_json& cell) { return NumberAt(cell, "frame_ms", "median"); }}};
  return quantities;
}

std::string TextOf(const nlohmann::ordered_json& cell, const char* key,
                   const std::filesystem::path& file) {
  const auto found = cell.find(key);
  if (found == cell.end() || !found->is_string()) {
    throw InputError(file, 0, key, "is missing; expected a text in every cell");
  }
  return found->get<std::string>();
}

std::string Short(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3g", value);
  return text;
}

}  // namespace

Figure AblationMatrixFigure(const FigureInput& input) {
  if (input.folders.size() != 1) {
    throw InputError("", 0, "--runs", "expected one folder of duet ablate");
  }
  const std::filesystem::path file = input.folders.front() / "ablation.json";
  if (!std::filesystem::exists(file)) {
    throw InputError(file, 0, "", "does not exist; expected the folder of duet ablate");
  }
  const nlohmann::ordered_json cells = ReadJsonFile(file);
  std::vector<std::string> estimators;
  std::vector<std::string> variants;
  for (const nlohmann::ordered_json& cell : cells) {
    for (const auto& [key, list] :
         {std::pair{"estimator", &estimators}, std::pair{"variant", &variants}}) {
      const std::string name = TextOf(cell, key, file);
      if (std::find(list->begin(), list->end(), name) == list->end()) list->push_back(name);
    }
  }
  if (cells.empty()) throw InputError(file, 0, "", "has no cell");

  Figure figure;
  figure.sources = {input.folders.front().string() + " (duet ablate)"};
  if (const std::string alignment = JsonText(cells.front(), "alignment"); !alignment.empty()) {
    figure.notes = {"Errors after alignment " + alignment + "."};
  }
  const std::size_t rows = std::min(variants.size(), kMostVariants);
  const auto cell_of = [&](const std::string& estimator, const std::string& variant) {
    return std::find_if(cells.begin(), cells.end(), [&](const nlohmann::ordered_json& cell) {
      return TextOf(cell, "estimator", file) == estimator &&
             TextOf(cell, "variant", file) == variant;
    });
  };
  for (const Quantity& quantity : Quantities()) {
    Panel panel{.title = quantity.title,
                .x = {.label = "",
                      .low = -0.5,
                      .high = static_cast<double>(estimators.size()) - 0.5,
                      .grid = false},
                .y = {.label = "estimated",
                      .low = -0.5,
                      .high = static_cast<double>(rows) - 0.5,
                      .grid = false},
                .height_mm = 4.4 * static_cast<double>(rows)};
    for (std::size_t i = 0; i < estimators.size(); ++i) {
      panel.x.ticks.emplace_back(static_cast<double>(i), estimators[i]);
    }
    std::vector<Series> bars;
    for (const Level& level : Levels()) {
      bars.push_back(BarSeries(level.legend, level.legend, level.look));
    }
    Series texts = TextSeries(quantity.title);
    for (std::size_t row = 0; row < rows; ++row) {
      const double y = static_cast<double>(rows - 1 - row);  // the first one above
      panel.y.ticks.emplace_back(y, variants[row]);
      for (std::size_t i = 0; i < estimators.size(); ++i) {
        const auto cell = cell_of(estimators[i], variants[row]);
        const auto none = cell_of(estimators[i], "none");
        if (cell == cells.end()) continue;
        const std::optional<double> value = quantity.of(*cell);
        if (!value) continue;
        const double x = static_cast<double>(i);
        AddText(x, y, Short(*value), &texts);
        std::optional<double> reference = quantity.aim > 0.0    ? std::optional(quantity.aim)
                                          : none == cells.end() ? std::nullopt
                                                                : quantity.of(*none);
        if (!reference || *reference <= 0.0) continue;
        const double ratio = *value / *reference;
        const auto level = std::find_if(Levels().begin(), Levels().end(), [ratio](const Level& l) {
          return ratio < l.below || std::isinf(l.below);
        });
        AddBar(x - 0.48, x + 0.48, y - 0.46, y + 0.46,
               &bars[static_cast<std::size_t>(level - Levels().begin())]);
      }
    }
    if (texts.texts.empty()) continue;  // no NEES of recordings
    panel.series = std::move(bars);
    panel.series.push_back(std::move(texts));
    figure.panels.push_back(std::move(panel));
  }
  figure.notes.push_back(
      "Colours: ratio to the same estimator with nothing estimated (none); of the NEES: to what "
      "is expected. Runs a cell: " +
      std::to_string(cells.front().value("runs", 0)) + ".");
  if (rows < variants.size()) {
    figure.notes.push_back("The first " + std::to_string(rows) + " of " +
                           std::to_string(variants.size()) + " combinations.");
  }
  return figure;
}

}  // namespace duet
