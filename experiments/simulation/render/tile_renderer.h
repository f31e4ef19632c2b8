#pragma once

#include <vector>

#include "experiments/simulation/render/band_geometry.h"
#include "experiments/simulation/render/ray_table.h"
#include "experiments/simulation/render/render_options.h"
#include "experiments/simulation/render/texture_sampler.h"

namespace duet {

/// How much of an image shows something.
struct PixelCounts {
  double seen = 0.0;   ///< pixels that see a surface
  double empty = 0.0;  ///< pixels that see nothing, though they have a ray
};

/// Samples the world's light pixel by pixel.
///
/// A pixel is looked at through its four corners. Where all see the same surface, its centre is
/// looked up in the surface's texture; where they differ, the pixel is sampled at the points of a
/// Fibonacci lattice, whose projections on any axis are spread evenly: a border lies where it is to
/// 1 / samples px. Surfaces narrower than a pixel may be missed between corners.
class TileRenderer {
 public:
  static constexpr int kMaxTile_px = 32;

  TileRenderer(const World& world, const RayTable& rays, const RenderSampling& sampling,
               bool by_columns);

  /// The light (grey levels at gain 1) of the tile's pixels, the mean over the instants, into
  /// `light`, an image by rows of the camera's size. Pixels without a ray get 0. `view`: the tile's
  /// RayTable::BoxOf.
  void Render(const BandGeometry& band, int instants, const Tile& tile, const RayBox& view,
              TileCandidates* scratch, float* light, PixelCounts* counts) const;

 private:
  // How a surface shines.
  struct Material {
    const TextureSampler* texture;
    float texels_per_m;
    float origin_u, origin_v;  // texels
    float brightness;
  };

  struct Sight {  // of the pixel that is rendered
    const BandGeometry& band;
    const TileCandidates& tile;
    const PlaneView* views;
  };
  // Adds one instant's share of the light. Returns how many pixels see nothing.
  double RenderInstant(const BandGeometry& band, int instants, int instant, const Tile& tile,
                       const TileCandidates& candidates, float* light) const;
  static int NearestOf(const Sight& sight, const Eigen::Vector2f& ray);
  [[nodiscard]] float Shade(const Sight& sight, int candidate, const Eigen::Vector2f& ray,
                            const Eigen::Vector2f& by_u, const Eigen::Vector2f& by_v,
                            bool four_samples) const;
  [[nodiscard]] float ShadeEdge(const Sight& sight, const PixelRays& rays, int samples,
                                double* empty) const;

  const RayTable& rays_;
  RenderSampling sampling_;
  bool by_columns_;
  std::vector<TextureSampler> textures_;
  std::vector<Material> materials_;  // one a surface
};

}  // namespace duet
