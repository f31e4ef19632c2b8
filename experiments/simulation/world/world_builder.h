#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/geometry/se3.h"
#include "common/support/random.h"
#include "experiments/simulation/world/canvas.h"
#include "experiments/simulation/world/illumination.h"
#include "experiments/simulation/world/world.h"
#include "experiments/simulation/world/world_library.h"

namespace duet {

/// Furnishes a world: takes rectangles and boxes with what paints them, and at the end lights and
/// bakes the textures, one for every face, on several threads. What a face shows depends on the
/// seed and on its number alone.
class WorldBuilder {
 public:
  /// Paints a canvas as wide and high as the face, x to the right and y up as seen from outside.
  using Painter = std::function<void(Canvas&, Random&)>;
  enum class Side { kLowX, kHighX, kLowY, kHighY, kLowZ, kHighZ };
  using SidePainter = std::function<void(Canvas&, Random&, Side)>;

  struct Look {
    double texel_m = 0.0;  ///< 0: the world's
    /// Surface::corner_density, measured: 1 is 15 or more of FAST's corners (threshold 20) per
    /// thousand pixels of a view of 752 x 480 from within the flight space.
    double corner_density = 1.0;
    double light = 0.0;  ///< > 0: a constant instead of the world's light (lamps, the sky)
    bool two_sided = false;
  };

  /// `texel_m`: what the world is meant for; options.texel_m, where set, coarsens or refines all.
  WorldBuilder(const std::string& name, const WorldOptions& options, double texel_m,
               double light_cell_m);

  /// For the furnishing; textures have their own.
  [[nodiscard]] Random& random() { return random_; }
  [[nodiscard]] Illumination& illumination() { return illumination_; }
  [[nodiscard]] World& world() { return *world_; }

  void AddRectangle(const Eigen::Vector3d& corner, const Eigen::Vector3d& u_axis,
                    const Eigen::Vector3d& v_axis, double width_m, double height_m,
                    const Look& look, Painter paint, int body = 0);
  /// The inside of a box: floor, ceiling, then the walls at low x, high x, low y and high y. The
  /// Side is where the face is.
  void AddInside(const Eigen::Vector3d& low, const Eigen::Vector3d& high, const Look& look,
                 const SidePainter& paint);
  /// A solid. Faces that the floor at z = 0 hides are left out.
  void AddBox(const Pose& pose, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
              const Look& look, const SidePainter& paint, int body = 0);

  /// Lights, bakes and hands over the world.
  [[nodiscard]] std::shared_ptr<const World> Build();

 private:
  struct Job {
    int surface;
    Look look;
    Painter paint;
  };
  [[nodiscard]] Texture Bake(const Surface& surface, const Job& job, std::uint64_t number) const;

  WorldOptions options_;
  double texel_m_;
  double texel_scale_;
  double light_cell_m_;
  Random random_;
  Illumination illumination_;
  std::shared_ptr<World> world_;
  std::vector<Job> jobs_;
};

/// Upright at a place of the floor, turned by yaw [rad].
[[nodiscard]] Pose Upright(double x, double y, double z, double yaw);

}  // namespace duet
