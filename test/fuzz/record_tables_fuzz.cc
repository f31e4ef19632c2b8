#include <cmath>

#include "common/support/logging.h"
#include "experiments/record_reader.h"
#include "test/fuzz/fuzz_reader.h"

// States and covariances: NEES against the states themselves is none, or not negative.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const std::vector<duet::InertialState> states =
        duet::ReadStateTable(duet::TakeFirstPart(&text), "f");
    duet::GroundTruth truth;
    for (const duet::InertialState& state : states) {
      truth.poses.push_back({state.instant, state.nav.pose()});
      truth.velocities.push_back(state.nav.v_GB);
      truth.biases.push_back(state.biases);
    }
    const std::vector<duet::RecordedCovariance> covariances = duet::ReadCovarianceTable(text, "g");
    const duet::NeesRun run = duet::ComputeNeesOfTables(states, covariances, truth);
    CHECK_LE(run.samples.size(), std::min(states.size(), covariances.size()));
    for (const duet::NeesSample& sample : run.samples) {
      for (const std::optional<double>& nees : sample.value) CHECK(!nees || *nees >= 0.0);
    }
  });
}
