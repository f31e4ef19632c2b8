#include <gflags/gflags.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/dataset/recording.h"
#include "common/support/input_error.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"
#include "evaluation/allan_report.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/gnuplot.h"
#include "experiments/record_folder.h"

namespace duet {
namespace {

// The samples from --start on, for --duration.
std::vector<ImuSample> Chosen(const std::vector<ImuSample>& imu) {
  if (FLAGS_start < 0.0) throw InputError("", 0, "--start", "expected 0 or more seconds");
  if (FLAGS_duration < 0.0) throw InputError("", 0, "--duration", "expected 0 or more seconds");
  const Timestamp start = imu.front().timestamp + ToNanoseconds(FLAGS_start);
  const Timestamp end =
      FLAGS_duration > 0.0 ? start + ToNanoseconds(FLAGS_duration) : imu.back().timestamp;
  std::vector<ImuSample> chosen;
  for (const ImuSample& sample : imu) {
    if (sample.timestamp >= start && sample.timestamp <= end) chosen.push_back(sample);
  }
  return chosen;
}

// The folder's own name, for the figure.
std::string NameOf(const std::string& dataset) {
  std::filesystem::path path = std::filesystem::absolute(dataset).lexically_normal();
  if (path.filename().empty()) path = path.parent_path();
  if (path.filename() == "mav0") path = path.parent_path();
  return path.filename();
}

int RunAllan(const CommandLine& /*line*/) {
  RequireAbsent(FLAGS_out);
  RecordingOptions imu_alone;
  imu_alone.source = RecordingOptions::Source::kNone;
  const Recording recording = LoadRecording(FLAGS_dataset, imu_alone);
  const ImuNoise& told = recording.imu_sensor.noise;
  const ImuAllan allan = AnalyzeImu(Chosen(recording.imu), recording.folder / "imu0" / "data.csv");
  nlohmann::ordered_json json;
  json["dataset"] = FLAGS_dataset;
  json["fingerprint"] = recording.fingerprint;
  json.update(AllanJson(allan, told));

  OutputFolder folder(FLAGS_out);
  WriteTextFile(folder.path() / "allan.csv", AllanCsv(allan));
  WriteTextFile(folder.path() / "allan.json", json.dump(2) + "\n");
  WriteTextFile(folder.path() / "allan.gp",
                AllanScript(allan, told, "Allan deviation, " + NameOf(FLAGS_dataset)));
  const bool drawn = RunGnuplot(folder.path(), "allan.gp");
  folder.Commit();
  std::fputs(AllanText(allan, told).c_str(), stdout);
  std::printf("%s in %s\n", drawn ? "allan.csv, .json, .svg, .pdf and .png" : "allan.csv and .json",
              folder.target().c_str());
  if (!drawn) {
    std::fprintf(
        stderr,
        "duet: gnuplot is not installed; run 'gnuplot allan.gp' there to draw the figure\n");
  }
  return kDone;
}

}  // namespace

Command AllanCommand() {
  return {.name = "allan",
          .summary = "Allan deviation of a recording at rest, and the noise densities in it.",
          .description =
              "Overlapping Allan deviations of the six axes of an IMU at rest, and a fit of white "
              "density, bias walk and bias instability to each: the numbers of sensor.yaml. Writes "
              "allan.csv, allan.json and, where gnuplot is installed, a figure (allan.gp draws it "
              "elsewhere). --start and --duration count from the IMU's first sample. An hour tells "
              "the white densities, several hours the walks.",
          .example = "duet allan --dataset resting_overnight --out allan",
          .flags = {{.name = "dataset", .value = "DIR", .required = true},
                    {.name = "out", .value = "DIR", .required = true},
                    {.name = "start", .value = "S"},
                    {.name = "duration", .value = "S"}},
          .run = RunAllan};
}

}  // namespace duet
