#include "experiments/simulated_dataset.h"

#include <opencv2/imgcodecs.hpp>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"
#include "experiments/interrupt.h"
#include "experiments/progress.h"
#include "experiments/simulation/render/render_recording.h"
#include "experiments/simulation/render/renderer.h"
#include "experiments/simulation/scenario.h"
#include "experiments/simulation/write_recording.h"

namespace duet {
namespace {

[[noreturn]] void ThrowNoSurfaces() {
  throw InputError("", 0, "world",
                   "a box has no surfaces to render; expected --world room, bare_room, hall or "
                   "street, or a preset with one of them");
}

}  // namespace

void ReadSimulatedDatasetOptions(ConfigSources* sources, SimulatedDatasetOptions* options) {
  sources->Read("simulation", &options->simulation);
  sources->Read("told_errors", &options->simulation.told_errors);
  sources->Read("render", &options->render);
}

WrittenDataset WriteSimulatedDataset(const SimulatedDatasetOptions& options,
                                     const std::string& settings_yaml,
                                     const std::filesystem::path& folder) {
  WrittenDataset written;
  OutputFolder output(folder);
  const Scenario scenario = MakeScenario(options.simulation, options.images);
  if (options.images && !scenario.world) ThrowNoSurfaces();
  const SimulatedRecording simulated = SimulateIn(scenario, options.simulation);
  if (Interrupted()) {
    written.interrupted = true;
    return written;
  }
  WriteSimulatedRecording(simulated, output.path(), options.tracks);
  if (scenario.recorded) {
    const RecordedMotionReport& report = scenario.recorded->report;
    WriteTextFile(output.path() / "recorded_motion.txt",
                  RecordedMotionText(report, scenario.start, true));
    written.summary = RecordedMotionText(report, scenario.start, false);
  }
  if (options.images) {
    const auto count = static_cast<std::int64_t>(simulated.frames.size()) *
                       static_cast<std::int64_t>(simulated.told_rig.cameras.size());
    Progress progress("rendering", count, "images", options.quiet);
    RenderRecording(simulated, scenario.world, options.render, output.path() / "mav0",
                    [&progress](int done) {
                      progress.Update(done);
                      return !Interrupted();
                    });
    if (Interrupted()) {
      written.interrupted = true;
      return written;
    }
    progress.Finish();
  }
  WriteTextFile(output.path() / "simulation.yaml", settings_yaml);
  output.Commit();
  written.summary += simulated.label + ": " + std::to_string(simulated.frames.size()) +
                     " frames of " + std::to_string(simulated.told_rig.cameras.size()) +
                     " camera(s), " + (options.images ? "images" : "tracks") + ", and " +
                     std::to_string(simulated.imu.size()) + " IMU samples in " +
                     output.target().string() + "\n";
  return written;
}

void WritePicture(const SimulatedDatasetOptions& options, double after_s,
                  const std::filesystem::path& file) {
  const Scenario scenario = MakeScenario(options.simulation, true);
  if (!scenario.world) ThrowNoSurfaces();
  const std::vector<Timestamp> frames = FrameStamps(scenario, options.simulation);
  const double last_s = SecondsBetween(frames.front(), frames.back());
  if (!(after_s >= 0.0 && after_s <= last_s)) {
    throw InputError("", 0, "--picture",
                     "expected a time within the simulation, 0 to " + FormatNumber(last_s) + " s");
  }
  const Timestamp stamp = frames.front() + ToNanoseconds(after_s);
  CheckIsFree(scenario, stamp);
  const Renderer renderer(options.render, TrueCamera(scenario.true_rig, scenario.world,
                                                     scenario.trajectory, scenario.start));
  const cv::Mat image = renderer.Render(0, stamp).image;
  bool written = false;
  try {
    written = cv::imwrite(file.string(), image);
  } catch (const cv::Exception&) {
    throw InputError("", 0, "--out", "expected a file that ends in .png or .jpg");
  }
  if (!written) throw OutputError(file.string(), "cannot be written");
}

SimulatedDatasetOptions ReadSimulationOf(const std::filesystem::path& dataset) {
  std::filesystem::path file = dataset / "simulation.yaml";
  if (!std::filesystem::exists(file)) file = dataset / ".." / "simulation.yaml";
  if (!std::filesystem::exists(file)) {
    throw InputError(dataset.string(), 0, "",
                     "has no simulation.yaml; expected a data set that duet simulate has written");
  }
  ConfigSources sources;
  sources.AddFile(file);
  SimulatedDatasetOptions options;
  ReadSimulatedDatasetOptions(&sources, &options);
  sources.CheckAllKeysUsed();
  return options;
}

}  // namespace duet
