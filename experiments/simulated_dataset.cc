#include "experiments/simulated_dataset.h"

#include <cstdio>

#include "common/support/input_error.h"
#include "common/support/output_folder.h"
#include "common/support/text_file.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/progress.h"
#include "experiments/simulation/render/render_recording.h"
#include "experiments/simulation/scenario.h"
#include "experiments/simulation/write_recording.h"

namespace duet {

void ReadSimulatedDatasetOptions(ConfigSources* sources, SimulatedDatasetOptions* options) {
  sources->Read("simulation", &options->simulation);
  sources->Read("told_errors", &options->simulation.told_errors);
  sources->Read("render", &options->render);
}

int WriteSimulatedDataset(const SimulatedDatasetOptions& options, const std::string& settings_yaml,
                          const std::filesystem::path& folder) {
  OutputFolder output(folder);
  const Scenario scenario = MakeScenario(options.simulation, options.images);
  if (options.images && !scenario.world) {
    throw InputError("", 0, "world",
                     "a box has no surfaces to render; expected --world room, "
                     "bare_room, hall or street, or a preset with one");
  }
  if (scenario.recorded && !options.quiet) {
    std::fputs(RecordedMotionText(scenario.recorded->report, scenario.start, false).c_str(),
               stdout);
  }
  const SimulatedRecording simulated = SimulateIn(scenario, options.simulation);
  WriteSimulatedRecording(simulated, output.path(), options.tracks);
  if (scenario.recorded) {
    WriteTextFile(output.path() / "recorded_motion.txt",
                  RecordedMotionText(scenario.recorded->report, scenario.start, true));
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
    if (Interrupted()) return kInterrupted;
    progress.Finish();
  }
  WriteTextFile(output.path() / "simulation.yaml", settings_yaml);
  output.Commit();
  std::printf("%s: %zu frames of %zu camera%s (%s) and %zu IMU samples in %s\n",
              simulated.label.c_str(), simulated.frames.size(), simulated.told_rig.cameras.size(),
              simulated.told_rig.cameras.size() == 1 ? "" : "s",
              options.images ? "images" : "tracks", simulated.imu.size(), output.target().c_str());
  return kDone;
}

}  // namespace duet
