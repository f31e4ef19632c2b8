#include <Eigen/Eigenvalues>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_runs.h"
#include "experiments/figures/figure_style.h"
#include "experiments/record_tables.h"

namespace duet {
namespace {

// Eigenvalues, descending, of S P^-1 S with the standard deviations S of before: how many times
// what was known of a direction is known after. Empty where P is not positive definite.
std::vector<double> InformationSpectrum(const Eigen::MatrixXd& P, const Eigen::VectorXd& before) {
  const Eigen::VectorXd inverse = before.cwiseInverse();
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * P * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled, Eigen::EigenvaluesOnly);
  std::vector<double> information;
  for (Eigen::Index i = 0; i < P.rows(); ++i) {
    const double variance = solver.eigenvalues()[i];
    if (!(variance > 0.0)) return {};
    information.push_back(1.0 / variance);
  }
  return information;
}

void AddSpectrum(const std::string& name, const Look& look, const std::vector<double>& spectrum,
                 Panel* panel) {
  std::vector<double> index;
  for (std::size_t i = 0; i < spectrum.size(); ++i) index.push_back(static_cast<double>(i + 1));
  Look points = look;
  points.width_pt = panel->series.empty() ? 1.6 : 0.9;  // where they coincide both are seen
  panel->series.push_back(PointSeries(name, name, points, index, spectrum));
}

// `duet observability --out FILE`: the calibration, in sigmas of its priors.
void AddObservability(const std::filesystem::path& file, Panel* panel) {
  const nlohmann::ordered_json json = ReadJsonFile(file);
  if (!json.contains("components") || !json.contains("cut")) {
    throw InputError(file, 0, "components", "is missing; expected a file of duet observability");
  }
  const auto size = static_cast<Eigen::Index>(json.at("components").size());
  Eigen::VectorXd prior(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    prior[i] =
        json.at("components").at(static_cast<std::size_t>(i)).at("prior_sigma").get<double>();
  }
  std::size_t n = 0;
  for (const auto& [key, name] :
       {std::pair{"cut", "tracks cut at the window"}, std::pair{"whole", "whole tracks"}}) {
    const nlohmann::ordered_json& rows = json.at(key).at("covariance");
    Eigen::MatrixXd P(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      for (Eigen::Index k = 0; k < size; ++k) {
        P(i, k) =
            rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(k)).get<double>();
      }
    }
    AddSpectrum(name, LookOf(n++), InformationSpectrum(P, prior), panel);
  }
}

// A run: the navigation state and biases at its end, in sigmas of its start.
void AddRun(const FigureRun& run, const Look& look, Panel* panel) {
  const std::filesystem::path file = run.folder / "covariance.csv";
  if (!std::filesystem::exists(file)) {
    throw InputError(run.folder.string() +
                     " has no covariance.csv; run it again with --covariance");
  }
  const std::vector<RecordedCovariance> rows = ReadCovarianceTable(ReadTextFile(file), file);
  if (rows.size() < 2) return;
  const Eigen::VectorXd before = rows.front().covariance.diagonal().cwiseSqrt();
  AddSpectrum(run.label, look, InformationSpectrum(rows.back().covariance, before), panel);
}

}  // namespace

Figure InformationSpectrumFigure(const FigureInput& input) {
  Figure figure;
  Panel panel{.x = {.label = "direction, from the best known to the least"},
              .y = {.label = "information over that of the prior [-]", .logarithmic = true},
              .height_mm = 50.0};
  const bool observability =
      input.folders.size() == 1 && std::filesystem::is_regular_file(input.folders.front());
  if (observability) {
    RequireNoChoice(input.choice, "a file of duet observability");
    AddObservability(input.folders.front(), &panel);
    figure.sources = {input.folders.front().string() + " (duet observability)"};
    figure.notes = {
        "Eigenvalues of the calibration's information matrix at the end, all else eliminated, in "
        "units of the priors: 1 is nothing learnt."};
  } else {
    const FoundRuns all = FindRuns(input);
    const std::vector<FigureRun> runs = ExampleRuns(all);
    const std::vector<Look> looks = LooksOf(runs);
    for (std::size_t n = 0; n < runs.size(); ++n) AddRun(runs[n], looks[n], &panel);
    figure.sources = DescribeSources(runs);
    figure.notes = {
        "Eigenvalues of the information matrix of θ, p, v, b_g, b_a at the end, in units of the "
        "start's standard deviations; under 1: less is known than at the start (yaw and position "
        "are unobservable)."};
    AddNote(FailedNote(ExampleCells(all), "drawn as far as it went"), &figure);
    AddNote(DrawnNote(all, runs), &figure);
  }
  double last = 0.0;
  for (const Series& series : panel.series) {
    last = std::max(last, static_cast<double>(series.columns[0].size()));
  }
  if (last == 0.0) throw InputError(input.folders.front(), 0, "", "has no positive covariance");
  panel.x.low = 0.0;
  panel.x.high = last + 1.0;
  panel.series.push_back(LineSeries("prior", "the prior alone", {.colour = kBlack, .width_pt = 0.5},
                                    {0.0, last + 1.0}, {1.0, 1.0}));
  figure.panels = {panel};
  return figure;
}

}  // namespace duet
