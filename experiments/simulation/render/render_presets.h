#pragma once

#include <string>
#include <vector>

#include "experiments/simulation/render/render_options.h"
#include "experiments/simulation/simulator.h"

namespace duet {

/// A simulation whose images are worth rendering.
struct RenderPreset {
  std::string name;
  std::string summary;
  SimulationOptions simulation;
  RenderOptions render;
};

/// 60 s each, along flights like EuRoC's: easy_room, difficult_room (fast, blur, changing light),
/// easy_hall, dark_hall (fast, dark, noisy), dark_hall_lit (the same without blur and noise), and
/// street_drive (a car, traffic).
[[nodiscard]] const std::vector<RenderPreset>& RenderPresets();
/// Null for another name.
[[nodiscard]] const RenderPreset* FindRenderPreset(const std::string& name);

}  // namespace duet
