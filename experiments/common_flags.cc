#include "experiments/common_flags.h"

#include <gflags/gflags.h>

DEFINE_string(dataset, "", "Recording in ASL form (EuRoC): the folder that holds mav0, or mav0.");
DEFINE_string(out, "", "Folder (duet observability: file) to write; must not exist yet.");
DEFINE_string(config, "", "Configuration file (YAML); later ones overrule earlier ones.");
DEFINE_string(set, "", "Sets one key of the configuration, e.g. msckf.window=15; see duet config.");
DEFINE_string(
    init, "auto",
    "Where the first state comes from: the recording's ground truth; drawn: its state at the "
    "first frame, off by errors drawn from the start covariance (initialization.sigma_*) "
    "with --seed; or standing still; auto: standing still, else a failure that says what was "
    "missing. Frames before the "
    "start have no estimate; a start later than 5 s, or than a fifth of the frames, is a "
    "warning.");
DEFINE_string(cameras, "0", "Cameras to use.");
DEFINE_double(start, 0.0,
              "Begin this long after the recording's first image (duet allan: IMU sample) [s].");
DEFINE_double(duration, 0.0,
              "Use images (duet allan: samples) for this long from --start; 0: to the end [s].");
DEFINE_string(alignment, "posyaw",
              "How the estimate is laid onto the truth before errors are "
              "taken.");
DEFINE_int32(threads, 1,
             "Threads of the image processing; results are the same bytes for any "
             "number.");
DEFINE_uint64(seed, 0, "Seed of everything that draws random numbers.");
DEFINE_bool(quiet, false, "No progress and no warnings on stderr.");

namespace duet {

std::vector<FlagUse> CommonFlags(bool dataset_required) {
  return {
      {.name = "dataset", .value = "DIR", .required = dataset_required},
      {.name = "out", .value = "DIR", .required = dataset_required},
      {.name = "config", .value = "FILE", .repeatable = true},
      {.name = "set", .value = "KEY=VALUE", .repeatable = true},
      {.name = "init",
       .value = "groundtruth|drawn|rest|auto",
       .choices = {"groundtruth", "drawn", "rest", "auto"}},
      {.name = "cameras", .value = "0|1|0,1", .choices = {"0", "1", "0,1"}},
      {.name = "start", .value = "S"},
      {.name = "duration", .value = "S"},
      {.name = "alignment",
       .value = "posyaw|se3|sim3|first|none",
       .choices = {"posyaw", "se3", "sim3", "first", "none"}},
      {.name = "threads", .value = "N"},
      {.name = "seed", .value = "N"},
      {.name = "quiet"},
  };
}

Configuration LoadConfiguration(const CommandLine& line, ConfigSources* sources) {
  for (const std::string& file : line.All("config")) sources->AddFile(file);
  for (const std::string& assignment : line.All("set")) sources->AddOverride(assignment);
  if (line.Given("threads")) {
    sources->AddOverride("frontend.threads=" + std::to_string(FLAGS_threads));
  }
  if (line.Given("alignment")) sources->AddOverride("evaluation.alignment=" + FLAGS_alignment);
  Configuration configuration;
  configuration.Read(sources);
  return configuration;
}

std::vector<int> CamerasAsked() {
  if (FLAGS_cameras == "0,1") return {0, 1};
  return {FLAGS_cameras == "1" ? 1 : 0};
}

}  // namespace duet
