#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "experiments/simulation/render/photometry.h"
#include "experiments/simulation/render/ray_table.h"
#include "experiments/simulation/render/render_options.h"
#include "experiments/simulation/render/tile_renderer.h"
#include "experiments/simulation/render/true_camera.h"

namespace duet {

/// An image of one camera, and what there is to say about it.
struct RenderedImage {
  cv::Mat image;             ///< CV_8UC1 of the camera's size
  double empty_share = 0.0;  ///< of the pixels that have a ray: those that see nothing (black)
  double gain = 1.0;
  int blur_instants = 1;  ///< within the exposure
};

/// Renders what the cameras of a rig see of a world: every row (or column) from the pose that the
/// rig has when it is read, exposed around that instant (bodies move meanwhile), through the
/// camera's own distortion, with textures filtered by what a pixel covers of them. On the CPU,
/// image by image in any order: the same options, stamp and camera give the same bytes for any
/// number of threads.
///
/// The trajectory is asked for the time of all rows and their exposure, and with auto_exposure for
/// its lag before (no earlier than its start): it has to be defined there.
class Renderer {
 public:
  /// CHECKs that the world has the textures that its surfaces name.
  Renderer(const RenderOptions& options, TrueCamera camera);
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  [[nodiscard]] const TrueCamera& camera() const { return camera_; }

  [[nodiscard]] RenderedImage Render(int camera, Timestamp stamp) const;

 private:
  // How far the image moves within the exposure at the most, px.
  [[nodiscard]] double LargestBlur(int camera, Timestamp stamp) const;

  // What is made once a camera.
  struct View {
    struct TileView {
      Tile tile;
      RayBox rays;
    };
    // Lines that are read together, and the tiles in them.
    struct Band {
      int first_line, line_count;
      RayBox rays;
      std::vector<TileView> tiles;
    };

    View(const CameraModel& model, bool by_columns);

    RayTable rays;
    std::vector<float> vignetting;
    std::vector<Band> bands;
    std::unique_ptr<TileRenderer> tiles;
  };

  RenderOptions options_;
  RenderSampling sampling_;
  TrueCamera camera_;
  GainControl gain_;
  std::vector<std::unique_ptr<View>> views_;  // one a camera
};

}  // namespace duet
