#pragma once

#include <string>
#include <vector>

namespace duet {

/// How an options struct describes itself: each field is named ONCE, in its struct's Visit, and
/// that one line drives reading, dumping, command-line overrides, range checks and `config
/// --explain`:
///
///   template <class Visitor> void Visit(Visitor& v) {
///     v.Field("max_tracks", &max_tracks, {.doc = "Most tracks in a frame.", .min = 10, .max =
///     2000}); v.Field("pixel_noise_px", &pixel_noise_px, {.doc = "...", .unit = "px", .min =
///     1e-3}); v.Group("calibration", &calibration, "...");   // a nested struct with its own Visit
///     v.Choice("solver", &solver, {{"dense", Solver::kDense}, ...}, {.doc = "..."});  // an enum
///   }
///
/// Field takes bool, int, double, std::string and std::vector<int>/<double>. Defaults are the
/// members' initializers.
struct FieldInfo {
  std::string doc;
  std::string unit;
  double min = -1e300;
  double max = 1e300;
};

}  // namespace duet
