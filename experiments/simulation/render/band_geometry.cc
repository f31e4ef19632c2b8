#include "experiments/simulation/render/band_geometry.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace duet {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// A body in the camera's frame: x_C = R x_body + p.
struct BodyView {
  Eigen::Matrix3d R;
  Eigen::Vector3d p;
};

std::vector<BodyView> BodyViews(const TrueCamera& camera, int index, double t_s) {
  const Pose T_CG = camera.PoseAt(index, t_s);
  std::vector<BodyView> views;
  for (const Pose& T_G_body : camera.world().BodyPoses(t_s)) {
    const Pose T_C_body = T_CG * T_G_body;
    views.push_back({T_C_body.R.toRotationMatrix(), T_C_body.p});
  }
  return views;
}

double InstantOffset(const BandShutter& shutter, int instant) {
  return ((instant + 0.5) / shutter.instants - 0.5) * shutter.exposure_s;
}

// Keeps track of whether all points that were added lie beyond one side of a view. Those behind the
// camera do so too: x <= x1 z and x >= x0 z with x0 < x1 contradict each other for z < 0.
class SideTest {
 public:
  explicit SideTest(const RayBox& view) : view_(view) {}
  void Add(const Eigen::Vector3f& p) {
    left_ = left_ && p.x() < view_.min().x() * p.z();
    right_ = right_ && p.x() > view_.max().x() * p.z();
    above_ = above_ && p.y() < view_.min().y() * p.z();
    below_ = below_ && p.y() > view_.max().y() * p.z();
    behind_ = behind_ && p.z() <= 0.0F;
  }
  [[nodiscard]] bool outside() const { return left_ || right_ || above_ || below_ || behind_; }

 private:
  const RayBox& view_;
  bool left_ = true, right_ = true, above_ = true, below_ = true, behind_ = true;
};

bool Outside(const BandGeometry::Candidate& candidate, const RayBox& view) {
  SideTest sides(view);
  for (const auto& corners : candidate.corners_C) {
    for (const Eigen::Vector3f& corner : corners) sides.Add(corner);
  }
  return sides.outside();
}

// A quick look before the corners are made: most surfaces of a world are out of view by far.
class SphereTest {
 public:
  explicit SphereTest(const RayBox& view) {
    const Eigen::Vector2d low = view.min().cast<double>();
    const Eigen::Vector2d high = view.max().cast<double>();
    inward_ << 1.0, 0.0, -low.x(),  // one side a row
        -1.0, 0.0, high.x(),        //
        0.0, 1.0, -low.y(),         //
        0.0, -1.0, high.y();
    inward_.rowwise().normalize();
  }

  // True where the sphere around a surface lies beyond one side at all poses.
  [[nodiscard]] bool Outside(
      const Surface& surface,
      const std::array<std::vector<BodyView>, BandGeometry::kPoses>& views) const {
    const Eigen::Vector3d center = surface.corner + 0.5 * surface.width_m * surface.u_axis +
                                   0.5 * surface.height_m * surface.v_axis;
    const double radius = 0.5 * std::hypot(surface.width_m, surface.height_m);
    Eigen::Array4d nearest = Eigen::Array4d::Constant(-1e300);
    for (const std::vector<BodyView>& bodies : views) {
      const BodyView& body = bodies[static_cast<std::size_t>(surface.body)];
      nearest = nearest.max((inward_ * (body.R * center + body.p)).array());
    }
    return nearest.minCoeff() < -radius;
  }

 private:
  Eigen::Matrix<double, 4, 3> inward_;
};

BandGeometry::Candidate MakeCandidate(
    const Surface& surface, int index,
    const std::array<std::vector<BodyView>, BandGeometry::kPoses>& views) {
  BandGeometry::Candidate candidate;
  candidate.surface = index;
  const Eigen::Vector3d u = surface.width_m * surface.u_axis;
  const Eigen::Vector3d v = surface.height_m * surface.v_axis;
  for (int pose = 0; pose < BandGeometry::kPoses; ++pose) {
    const BodyView& view = views[pose][static_cast<std::size_t>(surface.body)];
    const Eigen::Vector3d corner = view.R * surface.corner + view.p;
    const Eigen::Vector3d u_C = view.R * u;
    const Eigen::Vector3d v_C = view.R * v;
    candidate.corners_C[pose] = {corner.cast<float>(), (corner + u_C).cast<float>(),
                                 (corner + v_C).cast<float>(), (corner + u_C + v_C).cast<float>()};
    candidate.views[pose] = ViewOf(surface, view.R, view.p);
  }
  return candidate;
}

bool SeenAtAll(const BandGeometry::Candidate& candidate) {
  return std::any_of(candidate.views.begin(), candidate.views.end(),
                     [](const PlaneView& view) { return view.width_m > 0.0F; });
}

// Depths of a candidate within a box of rays: inverse depth is linear in the ray, its extremes are
// in the box's corners; the surface's own corners bound it too.
struct DepthBounds {
  float max_inverse = 0.0F;
  float min_inverse = kInfinity;
  bool fills = true;
};

DepthBounds BoundDepth(const BandGeometry::Candidate& candidate, const RayBox& view) {
  DepthBounds bounds;
  float nearest = kInfinity;
  for (const auto& corners : candidate.corners_C) {
    for (const Eigen::Vector3f& corner : corners) nearest = std::min(nearest, corner.z());
  }
  for (const PlaneView& plane : candidate.views) {
    for (const auto corner :
         {RayBox::BottomLeft, RayBox::BottomRight, RayBox::TopLeft, RayBox::TopRight}) {
      const Eigen::Vector2f ray = view.corner(corner);
      const float q = plane.InverseDepth(ray);
      bounds.max_inverse = std::max(bounds.max_inverse, q);
      bounds.min_inverse = std::min(bounds.min_inverse, q);
      bounds.fills = bounds.fills && q > 0.0F && plane.Within(ray, q);
    }
  }
  if (nearest > 0.0F) bounds.max_inverse = std::min(bounds.max_inverse, 1.0F / nearest);
  // Between the three poses depths go on a little.
  bounds.max_inverse *= 1.02F;
  bounds.min_inverse *= bounds.min_inverse > 0.0F ? 0.98F : 1.0F;
  return bounds;
}

}  // namespace

BandGeometry::BandGeometry(const TrueCamera& camera, const BandShutter& shutter, const RayBox& view)
    : first_line_(shutter.first_line),
      instants_(shutter.instants),
      lines_differ_(camera.rig().t_r_s != 0.0) {
  const auto time_of = [&](int line, int instant) {
    return camera.TimeOfLine(shutter.camera, shutter.stamp, line) + InstantOffset(shutter, instant);
  };
  const int last_line = shutter.first_line + shutter.line_count - 1;
  const int last_instant = shutter.instants - 1;
  double begin_s = time_of(shutter.first_line, 0);
  double end_s = time_of(last_line, last_instant);
  if (camera.rig().t_r_s < 0.0) {
    begin_s = time_of(last_line, 0);
    end_s = time_of(shutter.first_line, last_instant);
  }
  const std::array<std::vector<BodyView>, kPoses> bounds = {
      BodyViews(camera, shutter.camera, begin_s),
      BodyViews(camera, shutter.camera, 0.5 * (begin_s + end_s)),
      BodyViews(camera, shutter.camera, end_s)};
  const std::vector<Surface>& surfaces = camera.world().surfaces();
  const SphereTest spheres(view);
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (spheres.Outside(surfaces[i], bounds)) continue;
    const Candidate candidate = MakeCandidate(surfaces[i], static_cast<int>(i), bounds);
    if (SeenAtAll(candidate) && !Outside(candidate, view)) candidates_.push_back(candidate);
  }

  const int lines = lines_differ_ ? shutter.line_count : 1;
  views_.reserve(static_cast<std::size_t>(lines) * static_cast<std::size_t>(instants_) *
                 candidates_.size());
  for (int line = 0; line < lines; ++line) {
    for (int instant = 0; instant < instants_; ++instant) {
      const std::vector<BodyView> bodies =
          BodyViews(camera, shutter.camera, time_of(first_line_ + line, instant));
      for (const Candidate& candidate : candidates_) {
        const Surface& surface = surfaces[static_cast<std::size_t>(candidate.surface)];
        const BodyView& body = bodies[static_cast<std::size_t>(surface.body)];
        views_.push_back(ViewOf(surface, body.R, body.p));
      }
    }
  }
}

void FindTileCandidates(const BandGeometry& band, const RayBox& view, TileCandidates* tile) {
  tile->list.clear();
  tile->filled = false;
  int filling = -1;
  float filling_inverse = 0.0F;  // of its farthest place
  const auto& candidates = band.candidates();
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (Outside(candidates[i], view)) continue;
    const DepthBounds bounds = BoundDepth(candidates[i], view);
    if (!(bounds.max_inverse > 0.0F)) continue;
    tile->list.push_back({static_cast<int>(i), bounds.max_inverse});
    if (bounds.fills && bounds.min_inverse > filling_inverse) {
      filling = static_cast<int>(i);
      filling_inverse = bounds.min_inverse;
    }
  }
  if (filling >= 0) {
    std::erase_if(tile->list, [&](const TileCandidate& c) {
      return c.candidate != filling && c.max_inverse_depth < filling_inverse;
    });
  }
  std::sort(tile->list.begin(), tile->list.end(),
            [](const TileCandidate& a, const TileCandidate& b) {
              return std::pair(-a.max_inverse_depth, a.candidate) <
                     std::pair(-b.max_inverse_depth, b.candidate);
            });
  tile->filled = filling >= 0 && tile->list.size() == 1;
}

}  // namespace duet
