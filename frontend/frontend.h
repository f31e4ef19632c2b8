#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>

#include "common/dataset/track_stream.h"
#include "common/imu/imu_sample.h"
#include "common/measurement/calibration.h"
#include "common/support/stage_timer.h"
#include "frontend/frontend_options.h"

namespace duet {

/// What became of the tracks of the first camera, in one frame or summed over all.
struct FrontendCounts {
  int kept = 0;              ///< tracks that came from the frame before
  int detected = 0;          ///< new tracks
  int lost_flow = 0;         ///< the patch was not found, or left the image
  int lost_backward = 0;     ///< forward-backward check
  int lost_anchor = 0;       ///< no longer look like the patch that they were
  int lost_outlier = 0;      ///< contradict the epipolar geometry
  int lost_crowded = 0;      ///< too near to an older track
  int stereo_matched = 0;    ///< observations in the further cameras
  int stereo_unmatched = 0;  ///< tracks of the first camera without a match, over those cameras
};

struct FrontendStatistics {
  int frames = 0;
  FrontendCounts frame;  ///< of the newest frame
  FrontendCounts total;
  Eigen::Vector3d b_g = Eigen::Vector3d::Zero();  ///< the front end's own gyro bias, rad/s
};

/// Images and gyroscope -> tracks (DESIGN.md section 4). Takes nothing from any estimator; the
/// calibration is what the recording says. Deterministic: the same images and samples give the same
/// bytes for any number of threads.
///
///   Frontend frontend(options, max_tracks, rig);
///   for (...) { frontend.AddImu(...); const TrackFrameSet& tracks = frontend.Process(t, images); }
class Frontend {
 public:
  /// Cameras in the order of `rig.cameras`; the first one leads: tracks live in it, the others see
  /// the same points by stereo matching. `max_tracks`: most tracks in a frame of one camera.
  Frontend(const FrontendOptions& options, int max_tracks, const RigCalibration& rig,
           std::uint64_t seed = 0);
  ~Frontend();
  Frontend(const Frontend&) = delete;
  Frontend& operator=(const Frontend&) = delete;

  /// In order of time. Samples up to the stamp + t_d of a frame should come before the frame; what
  /// is missing is bridged with the last rate.
  void AddImu(const ImuSample& sample);

  /// One stamp's images, 8 bit grey, of the cameras' calibrated sizes (CHECKed); stamps increase.
  /// An image other than the first may be empty (could not be read): its frame then is too.
  /// The result is valid until the next call.
  const TrackFrameSet& Process(Timestamp timestamp, std::span<const cv::Mat> images);

  [[nodiscard]] const FrontendStatistics& statistics() const;

  /// Stages ("pyramid", "klt", "anchor", "outliers", "detect", "stereo") are timed into it where it
  /// is not null; not owned.
  void set_stage_timer(StageTimer* timer);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace duet
