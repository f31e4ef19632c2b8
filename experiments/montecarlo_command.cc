#include <gflags/gflags.h>

#include <cstdio>

#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/simulation/monte_carlo.h"

DECLARE_string(backend);
DECLARE_string(preset);
DEFINE_int32(runs, 20, "Simulated recordings, one seed each.");
DEFINE_double(noise_scale, 1.0,
              "Multiplies start errors, IMU noise, pixel noise and calibration priors.");

namespace duet {
namespace {

int RunMonteCarloCommand(const CommandLine& line) {
  ConfigSources sources;
  for (const std::string& file : line.All("config")) sources.AddFile(file);
  for (const std::string& assignment : line.All("set")) sources.AddOverride(assignment);
  if (line.Given("seed")) sources.AddOverride("simulation.seed=" + std::to_string(FLAGS_seed));
  MonteCarloOptions options;
  options.simulation = SimulationPreset(FLAGS_preset);
  options.runs = FLAGS_runs;
  options.threads = FLAGS_threads;
  options.noise_scale = FLAGS_noise_scale;
  sources.Read("simulation", &options.simulation);
  Configuration configuration;
  configuration.Read(&sources);
  options.shared = configuration.shared;
  options.start = configuration.initialization;
  const EvaluationSettings& evaluation = configuration.evaluation;
  RequireEvaluationDefaults(
      sources.values(),
      {{"association", "in duet montecarlo, where the truth is known at every instant"},
       {"max_truth_gap_s", "in duet montecarlo, where the truth is known at every instant"},
       {"relative_lengths_m", "in duet montecarlo, which takes no relative errors"}});
  options.settle_s = evaluation.nees_settle_s;
  options.alignment = evaluation.alignment;
  options.alignment_options = evaluation.Options().alignment_options;
  const MonteCarloResult result = RunMonteCarlo(options, [&](const EstimatorSetup& setup) {
    return MakeEstimator(FLAGS_backend, setup, configuration.backends);
  });
  std::fputs(MonteCarloText(FLAGS_backend, result).c_str(), stdout);
  std::printf("  ATE after alignment %s\n", AlignmentModeName(evaluation.alignment));
  return kDone;
}

}  // namespace

Command MonteCarloCommand() {
  return {
      .name = "montecarlo",
      .summary = "Consistency of an estimator over many simulated recordings.",
      .description =
          "Simulates --runs recordings, starts the estimator off the truth by errors drawn from "
          "its own start covariance, and prints the normalized errors (NEES) of each part of "
          "the state with the bands that they should lie in, and the errors over the runs. "
          "--set takes the keys of duet config and of simulation (duet simulate).",
      .example = "duet montecarlo --backend msckf --runs 100 --threads 2",
      .flags = {{.name = "backend", .value = "NAME", .required = true, .choices = EstimatorNames()},
                {.name = "preset", .value = "NAME", .choices = SimulationPresetNames()},
                {.name = "runs", .value = "N"},
                {.name = "noise-scale", .value = "X"},
                {.name = "config", .value = "FILE", .repeatable = true},
                {.name = "set", .value = "KEY=VALUE", .repeatable = true},
                {.name = "seed", .value = "N"},
                {.name = "threads", .value = "N"}},
      .run = RunMonteCarloCommand};
}

}  // namespace duet
