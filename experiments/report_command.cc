#include <gflags/gflags_declare.h>

#include <cstdio>
#include <filesystem>

#include "common/support/input_error.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/report/report.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

int RunReport(const CommandLine& line) {
  if (line.operands().size() != 1) {
    throw InputError("duet report expects one folder: of a study, of duet compare, or of a run");
  }
  const fs::path folder = line.operands().front();
  std::error_code ignored;
  if (!FLAGS_out.empty() && fs::exists(FLAGS_out, ignored)) {
    throw InputError(FLAGS_out, 0, "", "exists; --out expects a file that does not exist yet");
  }
  const fs::path file = FLAGS_out.empty() ? folder / "report.html" : fs::path(FLAGS_out);
  const std::size_t size = WriteReport(folder, file);
  std::printf("%s: %.1f MB\n", file.c_str(), static_cast<double>(size) / 1e6);
  return kDone;
}

}  // namespace

Command ReportCommand() {
  return {.name = "report",
          .summary = "One page that shows a study, a comparison or a run; it opens offline.",
          .description =
              "Writes one HTML file that needs no other file and no network: a summary in words, "
              "tables, the figures that are in DIR/figures, and an interactive part with the "
              "trajectories in 3-D, truth, covariance ellipsoids and errors over time. It is made "
              "from the records in DIR alone; curves are thinned without losing extremes, so that "
              "a study of 20 runs stays below 5 MB. Without --out it is DIR/report.html, which is "
              "replaced.",
          .example = "duet report out/head_to_head",
          .flags = {{.name = "out", .value = "FILE", .without = "DIR/report.html"}},
          .operands = "DIR",
          .run = RunReport};
}

}  // namespace duet
