#include "experiments/default_recording.h"

#include "experiments/simulation/simulator.h"
#include "experiments/simulation/write_recording.h"

namespace duet {

void WriteDefaultRecording(const std::filesystem::path& folder, int cameras, std::uint64_t seed) {
  SimulationOptions options = SimulationPreset(cameras == 2 ? "room_easy_stereo" : "room_easy");
  if (seed != 0) options.seed = static_cast<int>(seed);
  WriteSimulatedRecording(Simulate(options), folder);
}

}  // namespace duet
