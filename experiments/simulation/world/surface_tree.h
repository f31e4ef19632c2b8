#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <vector>

namespace duet {

struct Surface;
struct WorldHit;

/// The surfaces of one body in a tree of axis-aligned boxes, for ray casting: a ray passes by most
/// of them without a look. Surfaces are inserted one by one, each beside the node at which the
/// boxes' total area grows least (Goldsmith and Salmon, "Automatic creation of object hierarchies
/// for ray tracing", 1987), so that the tree is ready at any time.
class SurfaceTree {
 public:
  /// `index`: its number in the world, what Cast gives back.
  void Insert(int index, const Surface& surface);

  /// Looks for a hit nearer than hit->distance_m (infinity where there is none yet) and puts it
  /// into *hit. Origin and unit direction in the body's frame. Of two surfaces at exactly the same
  /// distance the one of the lower number is hit.
  void Cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, WorldHit* hit) const;

 private:
  // What of a Surface a ray is tested against.
  struct Rectangle {
    Eigen::Vector3d corner, u_axis, v_axis, normal;
    double width_m, height_m;
    bool two_sided;
    int index;
  };
  struct Node {
    Eigen::AlignedBox3d box;
    int parent = -1;
    int children[2] = {-1, -1};
    int rectangle = -1;  // of a leaf
  };

  [[nodiscard]] int FindSibling(const Eigen::AlignedBox3d& box) const;
  static void Test(const Rectangle& rectangle, const Eigen::Vector3d& origin,
                   const Eigen::Vector3d& direction, WorldHit* hit);

  std::vector<Rectangle> rectangles_;
  std::vector<Node> nodes_;
  int root_ = -1;
};

}  // namespace duet
