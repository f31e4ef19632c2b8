#include "backends/window/landmark_table.h"

#include <algorithm>
#include <cmath>

namespace duet {

Landmark& LandmarkTable::FindOrAdd(std::uint64_t track_id, std::size_t sorted) {
  const auto end = landmarks_.begin() + static_cast<std::ptrdiff_t>(sorted);
  const auto before = [](const Landmark& l, std::uint64_t id) { return l.track_id < id; };
  const auto known = std::lower_bound(landmarks_.begin(), end, track_id, before);
  if (known != end && known->track_id == track_id) return *known;
  // Ids within one camera's frame ascend, so those added from it are sorted too.
  const auto added = std::lower_bound(end, landmarks_.end(), track_id, before);
  if (added != landmarks_.end() && added->track_id == track_id) return *added;
  Landmark landmark;
  landmark.track_id = track_id;
  if (!spare_.empty()) {
    landmark.observations = std::move(spare_.back());
    landmark.observations.clear();
    spare_.pop_back();
  }
  return *landmarks_.insert(added, std::move(landmark));
}

int LandmarkTable::AddFrame(const TrackFrameSet& frames, int frame, const RigCalibration& rig) {
  for (Landmark& landmark : landmarks_) landmark.seen_newest = false;
  const std::size_t sorted = landmarks_.size();
  int count = 0;
  for (const TrackFrame& camera_frame : frames.frames) {
    for (const TrackObservation& o : camera_frame.observations) {
      ++count;
      const Eigen::Vector2d uv(o.u, o.v);
      const CameraCalibration& camera = rig.cameras[camera_frame.camera];
      const auto direction_C = camera.model.Unproject(uv);
      if (!direction_C) continue;
      Landmark& landmark = FindOrAdd(o.track_id, sorted);
      const Eigen::Vector3d bearing_B = camera.R_CB.conjugate() * direction_C->normalized();
      landmark.observations.push_back({frame, {camera_frame.camera, uv}, bearing_B});
      landmark.seen_newest = true;
    }
  }
  std::inplace_merge(landmarks_.begin(), landmarks_.begin() + static_cast<std::ptrdiff_t>(sorted),
                     landmarks_.end(),
                     [](const Landmark& a, const Landmark& b) { return a.track_id < b.track_id; });
  return count;
}

void LandmarkTable::KeepFrom(int first_kept, const WindowPoint& point, Landmark* landmark) {
  const int old_anchor = landmark->anchor();
  std::erase_if(landmark->observations,
                [&](const LandmarkObservation& o) { return o.frame < first_kept; });
  if (!landmark->has_value || landmark->observations.empty()) return;
  const int new_anchor = landmark->anchor();
  if (new_anchor == old_anchor) return;
  landmark->depth_known = false;
  landmark->has_value =
      landmark->value.z() > 0.0 &&
      LandmarkFromGlobal(point.rig, point.nav[new_anchor].pose(),
                         LandmarkInGlobal(point.rig, point.nav[old_anchor].pose(), landmark->value),
                         &landmark->value);
}

void LandmarkTable::DropFrame(int frame, const WindowPoint& point) {
  for (Landmark& landmark : landmarks_) {
    if (landmark.observations.empty()) continue;
    const int old_anchor = landmark.anchor();
    if (old_anchor == frame) {
      KeepFrom(frame + 1, point, &landmark);
    } else {
      std::erase_if(landmark.observations,
                    [&](const LandmarkObservation& o) { return o.frame == frame; });
    }
    for (LandmarkObservation& o : landmark.observations) {
      if (o.frame > frame) --o.frame;
    }
  }
  RemoveEmpty();
}

void LandmarkTable::RemoveEmpty() {
  for (Landmark& landmark : landmarks_) {
    if (landmark.observations.empty() && landmark.observations.capacity() > 0) {
      spare_.push_back(std::move(landmark.observations));
    }
  }
  std::erase_if(landmarks_, [](const Landmark& l) { return l.observations.empty(); });
}

bool HasParallax(const Landmark& landmark, const WindowPoint& point, double min_parallax_rad) {
  const double sin_min = std::sin(min_parallax_rad);
  const Eigen::Vector3d first =
      point.nav[landmark.anchor()].R_GB * landmark.observations.front().bearing_B;
  for (const LandmarkObservation& o : landmark.observations) {
    const Eigen::Vector3d ray = point.nav[o.frame].R_GB * o.bearing_B;
    if (first.cross(ray).squaredNorm() > sin_min * sin_min) return true;
  }
  return false;
}

bool FixByAnchorPixel(const RigCalibration& rig, Landmark* landmark) {
  const LandmarkObservation& anchor = landmark->observations.front();
  if (anchor.pixel.camera != 0) return false;
  const auto direction = rig.cameras[0].model.Unproject(anchor.pixel.uv);
  if (!direction) return false;
  landmark->value.head<2>() = direction->head<2>();
  return true;
}

}  // namespace duet
