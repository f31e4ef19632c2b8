#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "common/measurement/gauge.h"
#include "common/measurement/told_checks.h"
#include "common/measurement/told_errors.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/nearest_name.h"
#include "common/support/text_file.h"
#include "experiments/ablation/ablation.h"
#include "experiments/ablation/ablation_report.h"
#include "experiments/ablation/recorded_run.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/observability/observed_simulation.h"
#include "experiments/progress.h"
#include "experiments/record_folder.h"
#include "experiments/seed_range.h"

DECLARE_string(seeds);
DECLARE_string(tracks);
DEFINE_string(simulate, "", "Simulated recordings of this preset instead of a data set.");
DEFINE_string(states, "all",
              "Blocks of the calibration to switch, with commas: T_g T_s T_a p_CB R_CB intrinsics "
              "distortion t_d t_r; all: all of them.");
DEFINE_string(design, "one_at_a_time",
              "Which subsets are estimated: none, each alone and all; every combination; none and "
              "all.");
DEFINE_string(perturb, "",
              "YAML with told_errors and told_offset as under shared.calibration: how the told "
              "calibration is made wrong, the same for every subset; none: not at all. Without it "
              "errors are drawn from the priors of --states.");
DEFINE_string(backends, "", "Estimators, with commas; empty: all.");
DEFINE_int32(jobs, 1, "Runs at once, in threads. Costs a frame want 1.");

namespace duet {
namespace {

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    names.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return names;
}

std::vector<std::string> ParseNames(const char* flag, const std::string& text,
                                    const std::vector<std::string>& known) {
  std::vector<std::string> chosen;
  for (const std::string& name : SplitList(text)) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw InputError("", 0, flag, "unknown name '" + name + "'" + DidYouMean(name, known));
    }
    if (std::find(chosen.begin(), chosen.end(), name) != chosen.end()) {
      throw InputError("", 0, flag, "'" + name + "' stands there twice");
    }
    chosen.push_back(name);
  }
  return chosen;
}

AblationDesign ParseDesign() {
  if (FLAGS_design == "combinations") return AblationDesign::kCombinations;
  if (FLAGS_design == "none_and_all") return AblationDesign::kNoneAndAll;
  return AblationDesign::kOneAtATime;
}

// The perturbation in force as a file that --perturb takes.
std::string PerturbationYaml(const CalibrationPriors& priors) {
  ConfigSources sources;
  ToldErrors errors = priors.told_errors;
  ToldOffset offset = priors.told_offset;
  sources.Read("told_errors", &errors);
  sources.Read("told_offset", &offset);
  return sources.ResolvedYaml();
}

void ReadPerturbation(const std::vector<std::string>& states, CalibrationPriors* priors) {
  if (PerturbationYaml(*priors) != PerturbationYaml({})) {
    throw InputError(
        "shared.calibration.told_errors, told_offset: have no effect in duet ablate; expected "
        "--perturb FILE");
  }
  if (FLAGS_perturb.empty()) {
    priors->told_errors = PriorErrorsOf(states, *priors);
    return;
  }
  if (FLAGS_perturb == "none") return;
  ConfigSources sources;
  sources.AddFile(FLAGS_perturb);
  sources.Read("told_errors", &priors->told_errors);
  sources.Read("told_offset", &priors->told_offset);
  sources.CheckAllKeysUsed();
}

AblationPlan ReadPlan(const SharedOptions& shared) {
  AblationPlan plan;
  const std::vector<std::string> states =
      FLAGS_states == "all" ? CalibrationBlockNames()
                            : ParseNames("--states", FLAGS_states, CalibrationBlockNames());
  plan.estimators = FLAGS_backends.empty()
                        ? EstimatorNames()
                        : ParseNames("--backends", FLAGS_backends, EstimatorNames());
  plan.variants = AblationVariants(states, ParseDesign());
  plan.priors = shared.calibration;
  ReadPerturbation(states, &plan.priors);
  for (const AblationVariant& variant : plan.variants) {
    const std::string error = GaugeError(PriorsOf(variant, plan.priors));
    if (!error.empty()) {
      throw InputError("shared.calibration.imu_frame: estimating " + variant.name + ": " + error);
    }
  }
  const SeedRange seeds = ParseSeeds(FLAGS_seeds);
  plan.first_seed = seeds.first;
  plan.last_seed = seeds.last;
  plan.threads = FLAGS_jobs;
  return plan;
}

std::vector<AblationCell> RunPlan(const AblationPlan& plan, const AblationRunner& runner) {
  const auto total = static_cast<std::int64_t>(plan.estimators.size() * plan.variants.size()) *
                     (plan.last_seed - plan.first_seed + 1);
  Progress progress("ablation", total, "runs", FLAGS_quiet);
  std::vector<AblationCell> cells = RunAblation(plan, runner, [&](int done) {
    progress.Update(done);
    return !Interrupted();
  });
  progress.Finish();
  return cells;
}

/// Everything a command line asks for, and what came of it.
struct Ablation {
  Session session;  ///< of a recording; its configuration alone for a simulation
  MonteCarloOptions simulation;
  AblationPlan plan;
  std::vector<AblationCell> cells;
  std::string tracks_sha256;  ///< of a recording
};

void RunOnSimulation(const CommandLine& line, Ablation* ablation) {
  ConfigSources& sources = ablation->session.sources;
  for (const std::string& file : line.All("config")) sources.AddFile(file);
  for (const std::string& assignment : line.All("set")) sources.AddOverride(assignment);
  MonteCarloOptions& options = ablation->simulation;
  options.simulation = SimulationPreset(FLAGS_simulate);
  sources.Read("simulation", &options.simulation);
  Configuration& configuration = ablation->session.configuration;
  configuration.Read(&sources);
  options.shared = configuration.shared;
  options.start = configuration.initialization;
  RequireEvaluationDefaults(
      sources.values(),
      {{"association", "in duet ablate --simulate, where the truth is known at every instant"},
       {"max_truth_gap_s", "in duet ablate --simulate, where the truth is known at every instant"},
       {"relative_lengths_m", "in duet ablate, which takes no relative errors"}});
  const EvaluationSettings& evaluation = configuration.evaluation;
  options.settle_s = evaluation.nees_settle_s;
  options.alignment = evaluation.alignment;
  options.alignment_options = evaluation.Options().alignment_options;
  options.told_from_priors = false;
  ablation->plan = ReadPlan(configuration.shared);
  ablation->cells = RunPlan(
      ablation->plan, [&](const std::string& estimator, const CalibrationPriors& priors, int seed) {
        MonteCarloOptions of_run = options;
        of_run.shared.calibration = priors;
        return RunOnce(of_run, seed, [&](const EstimatorSetup& setup) {
          return MakeEstimator(estimator, setup, configuration.backends);
        });
      });
}

// What the first seed's motion allows: the Cramer-Rao bound with tracks cut at the estimator's
// window (duet observability).
Eigen::VectorXd PredictSigma(const Ablation& ablation, const AblationCell& cell) {
  if (cell.variant.estimated.empty()) return {};
  MonteCarloOptions options = ablation.simulation;
  options.simulation.seed = ablation.plan.first_seed;
  SharedOptions shared = options.shared;
  shared.calibration =
      ScaledPriors(PriorsOf(cell.variant, ablation.plan.priors), options.simulation.noise_scale);
  const SimulatedRecording recording = Simulate(options.simulation);
  const FisherInformation information(
      ObserveSimulation(recording, shared, StartCovariance(options.start, 1.0)));
  const BackendOptions& backends = ablation.session.configuration.backends;
  const bool filter = cell.estimator == "msckf";
  const PredictedCovariance predicted = information.Predict(
      {.window_frames = filter ? backends.msckf.max_clones : backends.window.max_frames,
       .min_observations = filter ? backends.msckf.min_observations : 2});
  return predicted.CalibrationCovariance().diagonal().cwiseSqrt();
}

// Of every seed.
void CheckToldOf(const AblationPlan& plan, const RigCalibration& rig) {
  CalibrationPriors priors = plan.priors;
  for (int seed = plan.first_seed; seed <= plan.last_seed; ++seed) {
    priors.told_errors_seed = seed;
    CheckTold(ToldRig(rig, priors), priors);
  }
}

void RunOnRecording(const CommandLine& line, Ablation* ablation) {
  Session& session = ablation->session;
  session = OpenSession(line, FLAGS_dataset, FLAGS_tracks);
  RequireEvaluationDefaults(
      session.sources.values(),
      {{"nees_settle_s",
        "in duet ablate --dataset, which claims no NEES and takes errors over all states"},
       {"relative_lengths_m", "in duet ablate, which takes no relative errors"}});
  if (!session.recording.truth) {
    throw InputError(session.recording.folder.string() +
                     ": has no ground truth; an ablation measures against it");
  }
  ablation->plan = ReadPlan(session.configuration.shared);
  CheckToldOf(ablation->plan, session.recording.rig);  // before the images are tracked
  const std::vector<TrackFrameSet> frames = TracksOf(session, FLAGS_quiet);
  if (frames.empty()) return;
  ablation->tracks_sha256 = HashTrackStream(frames);
  ablation->cells = RunPlan(ablation->plan,
                            [&](const std::string& estimator, CalibrationPriors priors, int seed) {
                              priors.told_errors_seed = seed;
                              return RunRecorded(session, frames, estimator, priors);
                            });
}

void CheckFlags(const CommandLine& line) {
  if (FLAGS_dataset.empty() == FLAGS_simulate.empty()) {
    throw InputError("expected either --dataset or --simulate");
  }
  if (FLAGS_jobs < 1) {
    throw InputError("", 0, "--jobs", "is " + std::to_string(FLAGS_jobs) + "; expected at least 1");
  }
  if (FLAGS_simulate.empty()) return;
  for (const char* flag : {"tracks", "init", "cameras", "start", "duration", "threads", "seed"}) {
    if (!line.Given(flag)) continue;
    throw InputError("", 0, "--" + std::string(flag),
                     "has no effect beside --simulate; expected keys of simulation by --set");
  }
}

int RunAblate(const CommandLine& line) {
  CheckFlags(line);
  RequireAbsent(FLAGS_out);
  LogCapture log(FLAGS_quiet);
  RecordFolder record(FLAGS_out, line.text(), log);
  const bool simulated = FLAGS_dataset.empty();
  Ablation ablation;
  simulated ? RunOnSimulation(line, &ablation) : RunOnRecording(line, &ablation);
  const std::vector<AblationCell>& cells = ablation.cells;
  if (cells.empty()) return kInterrupted;
  std::map<const AblationCell*, Eigen::VectorXd> predictions;
  for (const AblationCell& cell : cells) {
    if (!simulated || Interrupted()) continue;
    try {
      predictions[&cell] = PredictSigma(ablation, cell);
    } catch (const InputError& error) {  // no bound for this cell; what was run is not lost
      LOG(WARNING) << cell.estimator << ", " << cell.variant.name
                   << ": no prediction: " << error.what();
    }
  }
  const AblationClaims claims{
      .consistency = simulated,
      .evaluation = ablation.session.configuration.evaluation,
      .predicted_sigma = [&](const AblationCell& cell) { return predictions[&cell]; }};
  const std::string text = AblationText(cells, claims);
  WriteTextFile(record.path() / "ablation.txt", text);
  WriteTextFile(record.path() / "ablation.json", AblationJson(cells, claims).dump(2) + "\n");
  WriteTextFile(record.path() / "perturbation.yaml", PerturbationYaml(ablation.plan.priors));
  WriteTextFile(record.path() / "runs.csv", AblationRunsCsv(cells, claims));
  WriteTextFile(record.path() / "calibration.csv", AblationCurvesCsv(cells));
  // config.yaml says what the states were before the design switched them.
  record.manifest()["states"] = FLAGS_states;
  record.manifest()["design"] = FLAGS_design;
  record.manifest()["estimators"] = ablation.plan.estimators;
  record.manifest()["seeds"] = FLAGS_seeds;
  if (!simulated) {
    record.manifest()["seed"] = FLAGS_seed;
    record.manifest()["tracks_sha256"] = ablation.tracks_sha256;
  }
  if (!simulated) record.manifest()["dataset"] = DescribeRecording(ablation.session.recording);
  record.Commit(ablation.session.sources);
  std::fputs(text.c_str(), stdout);
  for (const AblationCell& cell : cells) {
    for (const MonteCarloRun& run : cell.runs) {
      if (!run.failed) continue;
      std::printf("failed: %s, %s, seed %d after %.1f s: %s\n", cell.estimator.c_str(),
                  cell.variant.name.c_str(), run.seed, run.coverage_s, run.reason.c_str());
    }
  }
  return kDone;
}

}  // namespace

Command AblateCommand() {
  return {
      .name = "ablate",
      .summary = "What estimating each part of the calibration is worth, for both estimators.",
      .description =
          "Runs both estimators on identical streams with every chosen subset of the calibration "
          "estimated and the rest fixed at its told value, which is made wrong on purpose, the "
          "same way for every subset: by default by errors drawn from the priors of --states "
          "(shared.calibration.*.sigma) with the run's seed. Prints accuracy, consistency "
          "(simulation only), cost, and the calibration's errors at the end beside what was "
          "reported; writes ablation.json, runs.csv and calibration.csv (the data of the "
          "convergence curves: error and sigma of every component over time). On a recording "
          "estimates are compared with its own calibration, which is no truth. Errors are those of "
          "duet compare: evaluation.alignment and, of a recording, evaluation.association say how "
          "they are taken. --set takes the keys of duet config and, with --simulate, of simulation "
          "(duet simulate).",
      .example =
          "duet ablate --simulate excited --states t_d,p_CB,intrinsics --seeds 1..10 --out "
          "ablation",
      .flags = {{.name = "dataset", .value = "DIR"},
                {.name = "simulate", .value = "NAME", .choices = SimulationPresetNames()},
                {.name = "tracks", .value = "DIR"},
                {.name = "out", .value = "DIR", .required = true},
                {.name = "states", .value = "LIST"},
                {.name = "design",
                 .value = "one_at_a_time|combinations|none_and_all",
                 .choices = {"one_at_a_time", "combinations", "none_and_all"}},
                {.name = "seeds", .value = "A..B", .required = true},
                {.name = "perturb", .value = "FILE|none"},
                {.name = "backends", .value = "LIST"},
                {.name = "jobs", .value = "N"},
                {.name = "config", .value = "FILE", .repeatable = true},
                {.name = "set", .value = "KEY=VALUE", .repeatable = true},
                {.name = "init",
                 .value = "groundtruth|rest|auto",
                 .choices = {"groundtruth", "rest", "auto"},
                 .meaning = "Where a recording's first state comes from: its ground truth; or "
                            "standing still; auto: standing still, else a failure that says what "
                            "was missing. Frames before the start have no estimate."},
                {.name = "cameras", .value = "0|1|0,1", .choices = {"0", "1", "0,1"}},
                {.name = "start", .value = "S"},
                {.name = "duration", .value = "S"},
                {.name = "threads", .value = "N"},
                {.name = "seed", .value = "N"},
                {.name = "quiet"}},
      .run = RunAblate};
}

}  // namespace duet
