#include "experiments/simulation/render/tile_renderer.h"

#include <algorithm>
#include <array>

#include "common/support/logging.h"

namespace duet {
namespace {

constexpr int kNothing = -1;

// Lattices (i / F_k, i F_(k-1) / F_k) of Fibonacci numbers F_k.
struct Lattice {
  int points;
  int step;
};
constexpr std::array<Lattice, 6> kLattices = {
    {{5, 3}, {8, 5}, {13, 8}, {21, 13}, {34, 21}, {55, 34}}};

Lattice LatticeOf(int points) {
  for (const Lattice& lattice : kLattices) {
    if (lattice.points >= points) return lattice;
  }
  return kLattices.back();
}

}  // namespace

TileRenderer::TileRenderer(const World& world, const RayTable& rays, const RenderSampling& sampling,
                           bool by_columns)
    : rays_(rays), sampling_(sampling), by_columns_(by_columns) {
  for (const Texture& texture : world.textures()) textures_.emplace_back(texture);
  for (const Surface& surface : world.surfaces()) {
    CHECK_GE(surface.texture, 0);
    CHECK_LT(surface.texture, static_cast<int>(world.textures().size()))
        << "world " << world.name() << " was made without textures";
    const Texture& texture = world.textures()[static_cast<std::size_t>(surface.texture)];
    const double per_m = 1.0 / texture.texel_m();
    materials_.push_back({&textures_[static_cast<std::size_t>(surface.texture)],
                          static_cast<float>(per_m),
                          static_cast<float>(per_m * surface.texture_origin_m.x()),
                          static_cast<float>(per_m * surface.texture_origin_m.y()),
                          static_cast<float>(surface.brightness)});
  }
}

int TileRenderer::NearestOf(const Sight& sight, const Eigen::Vector2f& ray) {
  int nearest = kNothing;
  float nearest_q = 0.0F;
  for (const TileCandidate& tile_candidate : sight.tile.list) {
    if (nearest_q > tile_candidate.max_inverse_depth) break;
    const PlaneView& view = sight.views[tile_candidate.candidate];
    const float q = view.InverseDepth(ray);
    if (!(q > nearest_q) || !view.Within(ray, q)) continue;
    nearest = tile_candidate.candidate;
    nearest_q = q;
  }
  return nearest;
}

float TileRenderer::Shade(const Sight& sight, int candidate, const Eigen::Vector2f& ray,
                          const Eigen::Vector2f& by_u, const Eigen::Vector2f& by_v,
                          bool four_samples) const {
  const PlaneView& view = sight.views[candidate];
  const int surface = sight.band.candidates()[static_cast<std::size_t>(candidate)].surface;
  const Material& material = materials_[static_cast<std::size_t>(surface)];
  const float q = view.InverseDepth(ray);
  if (!(q > 0.0F)) return 0.0F;
  // Place and, by the quotient rule, its change over the pixel.
  const float depth = 1.0F / q;
  const float scale = material.texels_per_m * depth;
  const float u_m = PlaneView::Dot(view.a, ray) * depth;
  const float v_m = PlaneView::Dot(view.b, ray) * depth;
  const Eigen::Vector2f u_slope = view.a.head<2>() - u_m * view.w.head<2>();
  const Eigen::Vector2f v_slope = view.b.head<2>() - v_m * view.w.head<2>();
  const TextureFootprint footprint = {material.texels_per_m * u_m + material.origin_u,
                                      material.texels_per_m * v_m + material.origin_v,
                                      scale * u_slope.dot(by_u),
                                      scale * v_slope.dot(by_u),
                                      scale * u_slope.dot(by_v),
                                      scale * v_slope.dot(by_v)};
  const TextureSampler& texture = *material.texture;
  const float value = four_samples ? texture.OverByFour(footprint, sampling_.max_probes)
                                   : texture.Over(footprint, sampling_.max_probes);
  return material.brightness * value;
}

float TileRenderer::ShadeEdge(const Sight& sight, const PixelRays& rays, int samples,
                              double* empty) const {
  const Lattice lattice = LatticeOf(samples);
  // Several samples share the pixel: each stands for half its extent.
  const Eigen::Vector2f by_u = 0.5F * rays.ByU();
  const Eigen::Vector2f by_v = 0.5F * rays.ByV();
  const float step = 1.0F / static_cast<float>(lattice.points);
  float sum = 0.0F;
  int nothing = 0;
  int row = 0;
  for (int i = 0; i < lattice.points; ++i) {
    const Eigen::Vector2f ray = rays.At((static_cast<float>(i) + 0.5F) * step - 0.5F,
                                        (static_cast<float>(row) + 0.5F) * step - 0.5F);
    row = (row + lattice.step) % lattice.points;
    const int nearest = NearestOf(sight, ray);
    if (nearest == kNothing) {
      ++nothing;
    } else {
      sum += Shade(sight, nearest, ray, by_u, by_v, false);
    }
  }
  *empty += static_cast<double>(nothing) / lattice.points;
  return sum * step;
}

void TileRenderer::Render(const BandGeometry& band, int instants, const Tile& tile,
                          const RayBox& view, TileCandidates* scratch, float* light,
                          PixelCounts* counts) const {
  if (!view.isEmpty()) {
    FindTileCandidates(band, view, scratch);
  } else {
    *scratch = {};
  }
  for (int v = tile.v; v < tile.v + tile.height; ++v) {
    float* row = light + static_cast<std::ptrdiff_t>(v) * rays_.width_px() + tile.u;
    std::fill(row, row + tile.width, 0.0F);
  }
  double empty = 0.0;
  for (int instant = 0; instant < instants; ++instant) {
    empty += RenderInstant(band, instants, instant, tile, *scratch, light);
  }
  double valid = 0.0;
  for (int v = tile.v; v < tile.v + tile.height; ++v) {
    for (int u = tile.u; u < tile.u + tile.width; ++u) valid += rays_.valid(u, v) ? 1.0 : 0.0;
  }
  counts->empty += empty / instants;
  counts->seen += valid - empty / instants;
}

double TileRenderer::RenderInstant(const BandGeometry& band, int instants, int instant,
                                   const Tile& tile, const TileCandidates& candidates,
                                   float* light) const {
  const int edge_samples = (sampling_.edge_samples + instants - 1) / instants;
  const float share = 1.0F / static_cast<float>(instants);
  const bool trivial = candidates.filled || candidates.list.empty();
  const int only = candidates.filled ? candidates.list.front().candidate : kNothing;
  const int first_line = by_columns_ ? tile.u : tile.v;
  const int lines = by_columns_ ? tile.width : tile.height;
  const int first_across = by_columns_ ? tile.v : tile.u;
  const int across = by_columns_ ? tile.height : tile.width;
  CHECK_LE(across, kMaxTile_px);
  // What the corners see along the borders of a line, as that line's views have it.
  std::array<int, kMaxTile_px + 1> before{}, after{};
  const auto look_along = [&](const Sight& sight, int border,
                              std::array<int, kMaxTile_px + 1>* ids) {
    for (int i = 0; i <= across; ++i) {
      const int place = first_across + i;
      (*ids)[static_cast<std::size_t>(i)] =
          NearestOf(sight, by_columns_ ? rays_.Corner(border, place) : rays_.Corner(place, border));
    }
  };

  double empty = 0.0;
  for (int line = first_line; line < first_line + lines; ++line) {
    const Sight sight = {band, candidates, band.Views(line, instant)};
    if (!trivial) {
      if (line > first_line && !band.lines_differ()) {
        before = after;
      } else {
        look_along(sight, line, &before);
      }
      look_along(sight, line + 1, &after);
    }
    for (int i = 0; i < across; ++i) {
      const int u = by_columns_ ? line : first_across + i;
      const int v = by_columns_ ? first_across + i : line;
      if (!rays_.valid(u, v)) continue;
      const auto place = static_cast<std::size_t>(i);
      const int seen = trivial ? only : before[place];
      const bool edge = !trivial && (before[place + 1] != seen || after[place] != seen ||
                                     after[place + 1] != seen);
      float value = 0.0F;
      if (edge) {
        value = ShadeEdge(sight, rays_.At(u, v), edge_samples, &empty);
      } else if (seen != kNothing) {
        const PixelRays rays = rays_.At(u, v);
        value = Shade(sight, seen, rays.center, rays.ByU(), rays.ByV(), sampling_.four_samples);
      } else {
        empty += 1.0;
      }
      light[static_cast<std::ptrdiff_t>(v) * rays_.width_px() + u] += share * value;
    }
  }
  return empty;
}

}  // namespace duet
