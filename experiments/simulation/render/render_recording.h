#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "experiments/simulation/render/render_options.h"
#include "experiments/simulation/simulator.h"
#include "experiments/simulation/world/world.h"

namespace duet {

/// What was rendered.
struct RenderReport {
  int images = 0;
  double largest_empty_share = 0.0;  ///< of an image's pixels that saw nothing
};

/// Renders what every camera of a recording sees at the stamps of its frames, and writes
/// mav/cam<k>/data/<stamp>.png, data.csv and sensor.yaml (as told). `mav` must hold no cam<k> yet.
/// Images are written in as many threads as render. `progress` hears of every image: how many are
/// done; rendering ends early where it says false (the folders are then incomplete).
/// Throws OutputError where writing fails, InputError for a view of which more than half sees
/// nothing.
RenderReport RenderRecording(const SimulatedRecording& recording,
                             std::shared_ptr<const World> world, const RenderOptions& options,
                             const std::filesystem::path& mav,
                             const std::function<bool(int done)>& progress);

}  // namespace duet
