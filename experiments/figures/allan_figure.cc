#include <cmath>
#include <nlohmann/json.hpp>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"

namespace duet {
namespace {

constexpr int kAllanColumns = 14;  // tau, clusters, six deviations, six fits

double Told(const nlohmann::ordered_json& json, const char* key, const std::string& file) {
  const auto told = json.find("told");
  if (told == json.end() || !told->contains(key) || !told->at(key).is_number()) {
    throw InputError(file, 0, std::string("told.") + key, "is missing; expected a number");
  }
  return told->at(key).get<double>();
}

}  // namespace

Figure AllanFigure(const FigureInput& input) {
  if (input.folders.size() != 1 || !std::filesystem::exists(input.folders.front() / "allan.csv")) {
    throw InputError("", 0, "--runs", "expected the folder of duet allan (it holds allan.csv)");
  }
  const std::filesystem::path file = input.folders.front() / "allan.csv";
  const std::filesystem::path json_file = input.folders.front() / "allan.json";
  const nlohmann::ordered_json json = ReadJsonFile(json_file);
  const std::string csv = ReadTextFile(file);
  CsvReader reader(csv, file, {ReadColumnNames(csv, file)});
  std::vector<std::vector<double>> columns(kAllanColumns);
  while (reader.Next()) {
    if (reader.column_count() != kAllanColumns) reader.Fail(0, "expected 14 columns");
    for (int k = 0; k < kAllanColumns; ++k) {
      columns[static_cast<std::size_t>(k)].push_back(reader.Number(k));
    }
  }
  reader.RequireRows();

  Figure figure;
  figure.sources = {file.string() + " of " + json.value("dataset", std::string("?")) + " (" +
                    json.value("fingerprint", std::string("?")).substr(0, 16) + ")"};
  struct Sensor {
    const char* label;
    std::size_t first;
    const char* white;
    const char* walk;
  };
  const std::vector<double>& tau = columns[0];
  for (const Sensor& sensor :
       {Sensor{"gyroscope [rad/s]", 2, "gyroscope_noise_density", "gyroscope_random_walk"},
        Sensor{"accelerometer [m/s²]", 5, "accelerometer_noise_density",
               "accelerometer_random_walk"}}) {
    Panel panel{.x = {.label = "averaging time τ [s]", .logarithmic = true},
                .y = {.label = sensor.label, .logarithmic = true},
                .height_mm = 42.0,
                .share_x = sensor.first == 2};
    const double white = Told(json, sensor.white, json_file);
    const double walk = Told(json, sensor.walk, json_file);
    std::vector<double> told;
    for (const double t : tau) told.push_back(std::sqrt(white * white / t + walk * walk * t / 3.0));
    panel.series.push_back(
        LineSeries("told", "as sensor.yaml tells", {.colour = kGrey, .width_pt = 2.4}, tau, told));
    const char* axes[] = {"x", "y", "z"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Look look = LookOf(axis);
      look.width_pt = 0.8;
      panel.series.push_back(
          PointSeries(axes[axis], axes[axis], look, tau, columns[sensor.first + axis]));
      panel.series.push_back(LineSeries(std::string(axes[axis]) + " fit",
                                        std::string(axes[axis]) + ", fit", look, tau,
                                        columns[sensor.first + 6 + axis]));
    }
    figure.panels.push_back(std::move(panel));
  }
  figure.notes = {
      "Overlapping Allan deviation; fit: white noise, instability and walk of the bias."};
  if (json.value("moves", false)) {
    figure.notes.emplace_back("The rig moves: these are no densities of the IMU.");
  }
  return figure;
}

}  // namespace duet
