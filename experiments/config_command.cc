#include <gflags/gflags.h>

#include <cstdio>

#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"

DEFINE_string(explain, "",
              "A key or a group of keys whose meaning, range, default and value in "
              "force are wanted, e.g. shared.pixel_noise_px.");

namespace duet {
namespace {

int RunConfig(const CommandLine& line) {
  ConfigSources sources;
  LoadConfiguration(line, &sources);
  const std::string text =
      line.Given("explain") ? sources.Explain(FLAGS_explain) : DocumentedYaml(sources.values());
  std::fputs(text.c_str(), stdout);
  return kDone;
}

}  // namespace

Command ConfigCommand() {
  return {.name = "config",
          .summary = "Prints every setting with its meaning, or explains one.",
          .description =
              "Prints the configuration in force, from the defaults, --config and --set, as a "
              "configuration file that documents each key; with --explain, what one key or group "
              "of keys means.",
          .example = "duet config --explain shared.calibration",
          .flags = {{"explain", "KEY"},
                    {.name = "config", .value = "FILE", .repeatable = true},
                    {.name = "set", .value = "KEY=VALUE", .repeatable = true}},
          .run = RunConfig};
}

}  // namespace duet
