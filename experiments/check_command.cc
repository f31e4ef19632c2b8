#include <gflags/gflags.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/check/doctor.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"

DECLARE_string(json);

namespace duet {
namespace {

int RunCheck(const CommandLine& /*line*/) {
  std::error_code ignored;
  if (!FLAGS_json.empty() && std::filesystem::exists(FLAGS_json, ignored)) {
    throw InputError(FLAGS_json, 0, "", "exists; --json expects a file that does not exist yet");
  }
  const Diagnosis diagnosis = Diagnose(FLAGS_dataset);
  std::fputs(DiagnosisText(diagnosis).c_str(), stdout);
  if (!FLAGS_json.empty()) WriteTextFile(FLAGS_json, DiagnosisJson(diagnosis).dump(2) + "\n");
  return diagnosis.Worst() == Severity::kError ? kBadInput : kDone;
}

}  // namespace

Command CheckCommand() {
  return {.name = "check",
          .summary = "A doctor for recordings: what is wrong with one, and what to do.",
          .description =
              "Checks a recording: rates, gaps and order of stamps, synchrony of the cameras, "
              "saturation and noise of the IMU, rest, calibration that can't be right, and the IMU "
              "against the truth: jumps, time shift, constant rotation, gravity. Each finding says "
              "what to do. Exit status 2 where something is an error.",
          .example = "duet check --dataset MH_03_medium --json mh03.json",
          .flags = {{.name = "dataset", .value = "DIR", .required = true},
                    {.name = "json", .value = "FILE"}},
          .run = RunCheck};
}

}  // namespace duet
