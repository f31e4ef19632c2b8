#include "experiments/simulation/render/renderer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/support/logging.h"
#include "experiments/simulation/render/parallel_for.h"

namespace duet {
namespace {

constexpr int kTile_px = 16;
constexpr std::uint64_t kNoiseStream = 0x6e6f697365;

}  // namespace

Renderer::View::View(const CameraModel& model, bool by_columns) : rays(model) {
  const int lines = by_columns ? rays.width_px() : rays.height_px();
  const int across = by_columns ? rays.height_px() : rays.width_px();
  for (int first = 0; first < lines; first += kTile_px) {
    Band band;
    band.first_line = first;
    band.line_count = std::min(kTile_px, lines - first);
    for (int start = 0; start < across; start += kTile_px) {
      const int count = std::min(kTile_px, across - start);
      const Tile tile = by_columns ? Tile{first, start, band.line_count, count}
                                   : Tile{start, first, count, band.line_count};
      band.tiles.push_back({tile, rays.BoxOf(tile)});
      band.rays.extend(band.tiles.back().rays);
    }
    bands.push_back(std::move(band));
  }
}

Renderer::Renderer(const RenderOptions& options, TrueCamera camera)
    : options_(options),
      sampling_(RenderSamplingOf(options.quality)),
      camera_(std::move(camera)),
      gain_(options.photometry, &camera_, options.seed) {
  for (const CameraCalibration& calibration : camera_.rig().cameras) {
    auto view = std::make_unique<View>(calibration.model, camera_.rig().readout_by_columns);
    view->vignetting = VignettingTable(calibration.model, options.photometry.vignetting);
    view->tiles = std::make_unique<TileRenderer>(camera_.world(), view->rays, sampling_,
                                                 camera_.rig().readout_by_columns);
    views_.push_back(std::move(view));
  }
}

double Renderer::LargestBlur(int camera, Timestamp stamp) const {
  constexpr int kColumns = 6;
  constexpr int kRows = 4;
  const CameraModel& model = camera_.model(camera);
  double largest = 0.0;
  for (int row = 0; row <= kRows; ++row) {
    for (int column = 0; column <= kColumns; ++column) {
      const Eigen::Vector2d uv(static_cast<double>(column) / kColumns * (model.width_px() - 1),
                               static_cast<double>(row) / kRows * (model.height_px() - 1));
      const auto point = camera_.PointAt(camera, stamp, uv);
      if (!point) continue;
      const double t_s = camera_.TimeOf(camera, stamp, uv);
      Eigen::Vector2d ends[2];
      bool seen = true;
      for (int i = 0; i < 2; ++i) {
        const double end_s = t_s + (i - 0.5) * options_.exposure_s;
        const Eigen::Vector3d p_C =
            camera_.PoseAt(camera, end_s) *
            camera_.world().PointInGlobal(point->surface, point->uv_m, end_s);
        seen = seen && model.Project(p_C, &ends[i]);
      }
      if (seen) largest = std::max(largest, (ends[1] - ends[0]).norm());
    }
  }
  return largest;
}

RenderedImage Renderer::Render(int camera, Timestamp stamp) const {
  CHECK_GE(camera, 0);
  CHECK_LT(camera, static_cast<int>(views_.size()));
  const View& view = *views_[static_cast<std::size_t>(camera)];
  const int width = view.rays.width_px();
  const int height = view.rays.height_px();
  RenderedImage result;
  result.gain = gain_.GainAt(camera, stamp);
  if (options_.exposure_s > 0.0) {
    const double wanted = std::round(sampling_.blur_samples_per_px * LargestBlur(camera, stamp));
    result.blur_instants =
        static_cast<int>(std::clamp(wanted, 1.0, static_cast<double>(sampling_.max_blur_samples)));
  }

  // Light, band by band of lines that are read together.
  std::vector<float> light(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::vector<PixelCounts> counts(view.bands.size());
  ParallelFor(static_cast<int>(view.bands.size()), options_.threads, [&](int index) {
    const View::Band& lines = view.bands[static_cast<std::size_t>(index)];
    if (lines.rays.isEmpty()) return;  // the light stays 0
    const BandGeometry band(camera_,
                            {.camera = camera,
                             .stamp = stamp,
                             .first_line = lines.first_line,
                             .line_count = lines.line_count,
                             .exposure_s = options_.exposure_s,
                             .instants = result.blur_instants},
                            lines.rays);
    TileCandidates scratch;
    for (const View::TileView& tile : lines.tiles) {
      view.tiles->Render(band, result.blur_instants, tile.tile, tile.rays, &scratch, light.data(),
                         &counts[static_cast<std::size_t>(index)]);
    }
  });
  PixelCounts total;
  for (const PixelCounts& band : counts) {
    total.seen += band.seen;
    total.empty += band.empty;
  }
  result.empty_share = total.empty > 0.0 ? total.empty / (total.empty + total.seen) : 0.0;

  // Grey levels, row by row, each with a noise of its own.
  result.image.create(height, width, CV_8UC1);
  const Random noise = Random(static_cast<std::uint64_t>(options_.seed), kNoiseStream)
                           .Fork(static_cast<std::uint64_t>(camera))
                           .Fork(static_cast<std::uint64_t>(stamp));
  const auto brightness = static_cast<float>(options_.photometry.light);
  ParallelFor(height, options_.threads, [&](int row) {
    const std::size_t first = static_cast<std::size_t>(row) * static_cast<std::size_t>(width);
    float* row_light = light.data() + first;
    const float* vignetting = view.vignetting.data() + first;
    for (int i = 0; i < width; ++i) row_light[i] *= brightness * vignetting[i];
    Random random = noise.Fork(static_cast<std::uint64_t>(row));
    QuantizeRow(options_.photometry, result.gain, row_light, width, &random,
                result.image.ptr<std::uint8_t>(row));
  });
  return result;
}

}  // namespace duet
