#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <vector>

#include "experiments/simulation/render/plane_view.h"
#include "experiments/simulation/render/ray_table.h"
#include "experiments/simulation/render/true_camera.h"

namespace duet {

/// Some lines of an image that are read one after the other, and the instants within the exposure
/// of each.
struct BandShutter {
  int camera = 0;
  Timestamp stamp = 0;
  int first_line = 0;
  int line_count = 0;
  double exposure_s = 0.0;
  int instants = 1;
};

/// The surfaces that a band of lines may show, as seen by each of its lines at each instant.
///
/// A surface is left out only where its corners lie beyond one and the same side of the view at the
/// beginning, the middle and the end of the band's time. Between these the corners' path bends by
/// (d^2 alpha / 8) dt^2, well below the pixel by which callers widen the box.
class BandGeometry {
 public:
  static constexpr int kPoses = 3;  // beginning, middle, end

  /// `view` is widened by a pixel by the caller.
  BandGeometry(const TrueCamera& camera, const BandShutter& shutter, const RayBox& view);

  struct Candidate {
    int surface;
    std::array<std::array<Eigen::Vector3f, 4>, kPoses> corners_C;
    std::array<PlaneView, kPoses> views;
  };
  [[nodiscard]] const std::vector<Candidate>& candidates() const { return candidates_; }

  /// The views of all candidates, in their order, for a line of the band.
  [[nodiscard]] const PlaneView* Views(int line, int instant) const {
    const int index = (lines_differ_ ? line - first_line_ : 0) * instants_ + instant;
    return views_.data() + static_cast<std::size_t>(index) * candidates_.size();
  }
  [[nodiscard]] bool lines_differ() const { return lines_differ_; }

 private:
  int first_line_;
  int instants_;
  bool lines_differ_;
  std::vector<Candidate> candidates_;
  std::vector<PlaneView> views_;
};

/// A surface that a tile may show: its number among the band's candidates and its nearest depth.
struct TileCandidate {
  int candidate;
  float max_inverse_depth;  ///< 1/m, infinity where the surface reaches the camera
};

/// What a tile may show, nearest first; surfaces wholly behind one that fills the tile are left
/// out.
struct TileCandidates {
  std::vector<TileCandidate> list;
  bool filled = false;  ///< list has one surface, and it fills the tile
};

/// `view` is widened by a pixel by the caller.
void FindTileCandidates(const BandGeometry& band, const RayBox& view, TileCandidates* tile);

}  // namespace duet
