#include "experiments/simulation/render/render_presets.h"

#include "experiments/simulation/euroc_sequences.h"

namespace duet {
namespace {

SimulationOptions FlightThrough(const std::string& world, const std::string& trajectory) {
  SimulationOptions options;
  options.world = world;
  options.trajectory = trajectory;
  options.duration_s = 60.0;
  options.rest_s = kEurocRest_s;
  return options;
}

std::vector<RenderPreset> MakePresets() {
  std::vector<RenderPreset> presets;
  presets.push_back({"easy_room", "room, slow, bright", FlightThrough("room", "V1_01_easy"), {}});

  RenderPreset difficult{"difficult_room",
                         "room, fast turns, motion blur, changing light",
                         FlightThrough("room", "V1_03_difficult"),
                         {}};
  difficult.render.exposure_s = 0.012;
  difficult.render.photometry.light = 0.6;
  difficult.render.photometry.gain_change = 0.3;
  difficult.render.photometry.noise_per_grey = 0.03;
  presets.push_back(difficult);

  presets.push_back(
      {"easy_hall", "machine hall, slow, bright", FlightThrough("hall", "MH_01_easy"), {}});

  RenderPreset dark{
      "dark_hall", "machine hall, fast, dark, noisy", FlightThrough("hall", "MH_05_difficult"), {}};
  dark.render.exposure_s = 0.012;
  dark.render.photometry.light = 0.12;
  dark.render.photometry.gain = 3.0;
  dark.render.photometry.noise_per_grey = 0.03;
  dark.render.photometry.noise_floor = 1.0;
  presets.push_back(dark);

  RenderPreset lit = dark;
  lit.name = "dark_hall_lit";
  lit.summary = "dark_hall with light on, without blur and noise";
  lit.render.exposure_s = 0.0;
  lit.render.photometry = {};
  lit.render.photometry.noise_per_grey = 0.0;
  lit.render.photometry.noise_floor = 0.0;
  presets.push_back(lit);

  RenderPreset street{"street_drive",
                      "a car in a street with traffic",
                      FlightThrough("street", "planar_driving"),
                      {}};
  street.simulation.moving_bodies = true;
  street.simulation.rest_s = 0.0;
  street.simulation.duration_s = 40.0;
  presets.push_back(street);
  return presets;
}

}  // namespace

const std::vector<RenderPreset>& RenderPresets() {
  static const std::vector<RenderPreset> presets = MakePresets();
  return presets;
}

const RenderPreset* FindRenderPreset(const std::string& name) {
  for (const RenderPreset& preset : RenderPresets()) {
    if (preset.name == name) return &preset;
  }
  return nullptr;
}

}  // namespace duet
