#pragma once

#include <cstdint>
#include <vector>

#include "backends/window/window_state.h"
#include "common/dataset/track_stream.h"

namespace duet {

/// The landmarks of the window with their pixels, sorted by track id. A landmark is anchored in the
/// first frame that it has a pixel in; where that one leaves, its value moves on to the next.
class LandmarkTable {
 public:
  /// Takes in a stamp's tracks as those of frame `frame`, the newest. Pixels that the camera model
  /// can't undistort are left out. Returns the number of pixels in the frame.
  int AddFrame(const TrackFrameSet& frames, int frame, const RigCalibration& rig);

  /// Forgets a frame's pixels; frames after it count down by one. Landmarks anchored there are
  /// anchored anew: the value is expressed in the next frame's camera (it must not be part of a
  /// prior). Landmarks without any pixel left end. `point` is the window before the frame is gone.
  void DropFrame(int frame, const WindowPoint& point);

  /// Forgets a landmark's pixels in frames before `first_kept`, moving its value on as above.
  static void KeepFrom(int first_kept, const WindowPoint& point, Landmark* landmark);

  /// Ends landmarks without pixels.
  void RemoveEmpty();

  [[nodiscard]] std::vector<Landmark>& landmarks() { return landmarks_; }
  [[nodiscard]] const std::vector<Landmark>& landmarks() const { return landmarks_; }

 private:
  Landmark& FindOrAdd(std::uint64_t track_id, std::size_t sorted);

  std::vector<Landmark> landmarks_;
  std::vector<std::vector<LandmarkObservation>> spare_;  // memory of ended landmarks
};

/// True where two rays of the landmark, the anchor's and a later one, differ by more than the
/// angle. Without, its depth is free: the solver would move it anywhere, and a point taken for near
/// pretends to fix the rig's position.
[[nodiscard]] bool HasParallax(const Landmark& landmark, const WindowPoint& point,
                               double min_parallax_rad);

/// Sets alpha and beta to what the anchor's pixel in camera C0 says, keeping rho: for the mode that
/// takes that pixel as free of noise. False where there is none or it can't be undistorted.
[[nodiscard]] bool FixByAnchorPixel(const RigCalibration& rig, Landmark* landmark);

}  // namespace duet
