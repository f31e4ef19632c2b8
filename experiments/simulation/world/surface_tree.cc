#include "experiments/simulation/world/surface_tree.h"

#include <algorithm>

#include "common/support/logging.h"
#include "experiments/simulation/world/world.h"

namespace duet {
namespace {

// Boxes of flat rectangles have no thickness; this much keeps a ray within the rectangle's plane,
// or one that hits it at its border, from missing its box by rounding.
constexpr double kBoxMargin_m = 1e-6;
// Rectangles that share a border overlap by this, so that rounding opens no gap between them.
constexpr double kSlack_m = 1e-9;
constexpr int kMaxDepth = 256;

double SurfaceArea(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d s = box.sizes();
  return s.x() * s.y() + s.y() * s.z() + s.z() * s.x();
}

// The distance at which a ray enters the box, infinity where it misses it or comes later than
// `limit`. A zero component's quotient may be NaN (origin in the face's plane): the comparisons are
// ordered such that it then decides nothing.
double Enter(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& origin,
             const Eigen::Vector3d& inverse, double limit) {
  double near = 0.0;
  double far = limit;
  for (int i = 0; i < 3; ++i) {
    const double t0 = (box.min()[i] - origin[i]) * inverse[i];
    const double t1 = (box.max()[i] - origin[i]) * inverse[i];
    near = std::max(near, std::min(t0, t1));
    far = std::min(far, std::max(t0, t1));
  }
  return near <= far ? near : std::numeric_limits<double>::infinity();
}

}  // namespace

int SurfaceTree::FindSibling(const Eigen::AlignedBox3d& box) const {
  int node = root_;
  while (nodes_[node].rectangle < 0) {
    const double area = SurfaceArea(nodes_[node].box);
    const double merged = SurfaceArea(nodes_[node].box.merged(box));
    // A new parent here against going on into a child, whose ancestors all grow by the difference.
    const double here = 2.0 * merged;
    const double inherited = 2.0 * (merged - area);
    double best = here;
    int next = -1;
    for (const int child : nodes_[node].children) {
      double cost = inherited + SurfaceArea(nodes_[child].box.merged(box));
      if (nodes_[child].rectangle < 0) cost -= SurfaceArea(nodes_[child].box);
      if (cost < best) {
        best = cost;
        next = child;
      }
    }
    if (next < 0) break;
    node = next;
  }
  return node;
}

void SurfaceTree::Insert(int index, const Surface& surface) {
  const Eigen::Vector3d u = surface.width_m * surface.u_axis;
  const Eigen::Vector3d v = surface.height_m * surface.v_axis;
  Eigen::AlignedBox3d box(surface.corner);
  box.extend(surface.corner + u);
  box.extend(surface.corner + v);
  box.extend(surface.corner + u + v);
  box.min().array() -= kBoxMargin_m;
  box.max().array() += kBoxMargin_m;

  const int leaf = static_cast<int>(nodes_.size());
  nodes_.push_back({.box = box, .rectangle = static_cast<int>(rectangles_.size())});
  rectangles_.push_back({surface.corner, surface.u_axis, surface.v_axis,
                         surface.u_axis.cross(surface.v_axis), surface.width_m, surface.height_m,
                         surface.two_sided, index});
  if (root_ < 0) {
    root_ = leaf;
    return;
  }
  const int sibling = FindSibling(box);
  const int parent = static_cast<int>(nodes_.size());
  const int grandparent = nodes_[sibling].parent;
  nodes_.push_back(
      {.box = nodes_[sibling].box, .parent = grandparent, .children = {sibling, leaf}});
  nodes_[sibling].parent = parent;
  nodes_[leaf].parent = parent;
  if (grandparent < 0) {
    root_ = parent;
  } else {
    int* children = nodes_[grandparent].children;
    children[children[0] == sibling ? 0 : 1] = parent;
  }
  int depth = 0;
  for (int node = parent; node >= 0; node = nodes_[node].parent, ++depth) {
    nodes_[node].box.extend(box);
  }
  CHECK_LT(depth, kMaxDepth - 1);
}

void SurfaceTree::Test(const Rectangle& rectangle, const Eigen::Vector3d& origin,
                       const Eigen::Vector3d& direction, WorldHit* hit) {
  const double slope = rectangle.normal.dot(direction);
  if (slope == 0.0 || (slope > 0.0 && !rectangle.two_sided)) return;
  const Eigen::Vector3d to_corner = rectangle.corner - origin;
  const double distance = rectangle.normal.dot(to_corner) / slope;
  if (!(distance > 0.0) || distance > hit->distance_m) return;
  if (distance == hit->distance_m && hit->surface < rectangle.index) return;
  const Eigen::Vector3d on_surface = distance * direction - to_corner;
  const double u = rectangle.u_axis.dot(on_surface);
  const double v = rectangle.v_axis.dot(on_surface);
  if (u < -kSlack_m || v < -kSlack_m) return;
  if (u > rectangle.width_m + kSlack_m || v > rectangle.height_m + kSlack_m) return;
  hit->distance_m = distance;
  hit->surface = rectangle.index;
  hit->uv_m = {u, v};
}

void SurfaceTree::Cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                       WorldHit* hit) const {
  if (root_ < 0) return;
  struct Entry {
    int node;
    double distance_m;
  };
  const Eigen::Vector3d inverse = direction.cwiseInverse();
  Entry stack[kMaxDepth];
  int count = 0;
  Entry entry = {root_, Enter(nodes_[root_].box, origin, inverse, hit->distance_m)};
  while (true) {
    // Strictly beyond: a surface at the very distance may have the lower number.
    if (entry.distance_m <= hit->distance_m && entry.distance_m < 1e300) {
      const Node& node = nodes_[entry.node];
      if (node.rectangle >= 0) {
        Test(rectangles_[node.rectangle], origin, direction, hit);
      } else {
        Entry first = {node.children[0],
                       Enter(nodes_[node.children[0]].box, origin, inverse, hit->distance_m)};
        Entry second = {node.children[1],
                        Enter(nodes_[node.children[1]].box, origin, inverse, hit->distance_m)};
        if (second.distance_m < first.distance_m) std::swap(first, second);
        if (second.distance_m < 1e300) stack[count++] = second;
        entry = first;
        continue;
      }
    }
    if (count == 0) return;
    entry = stack[--count];
  }
}

}  // namespace duet
