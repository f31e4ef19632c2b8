#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/dataset/asl_sensors.h"
#include "common/dataset/ground_truth.h"
#include "common/dataset/track_files.h"
#include "common/dataset/track_stream.h"
#include "common/imu/imu_sample.h"

namespace duet {

/// The image files of one stamp, one a camera of the rig, in its order.
struct ImageStamp {
  Timestamp timestamp = 0;
  std::vector<std::string> paths;
};

enum class Vision { kNone, kImages, kTracks };

/// Everything that a recording in ASL form holds, read and checked.
struct Recording {
  std::filesystem::path folder;  ///< that holds imu0
  ImuSensor imu_sensor;
  std::vector<ImuSample> imu;
  RigCalibration rig;               ///< the chosen cameras, in the order chosen
  std::vector<int> camera_numbers;  ///< k of cam<k> or tracks<k>, one a camera of the rig
  std::vector<CameraSensor> camera_sensors;

  Vision vision = Vision::kNone;
  std::vector<ImageStamp> images;  ///< of kImages: stamps at which every chosen camera has one
  int unpaired_images = 0;  ///< stamps inside the cameras' common span that one of them lacks
  TrackStream tracks;       ///< of kTracks

  std::optional<GroundTruth> truth;
  std::string truth_file;
  /// What it is, for tables, where it is not just a recording: recording.yaml's `label`.
  std::string label;
  /// SHA-256 of what was read: names and bytes of tables and sensor files, names and sizes of
  /// images.
  std::string fingerprint;
  std::vector<std::string> warnings;

  [[nodiscard]] Eigen::Vector3d g_G() const { return {0, 0, -imu_sensor.gravity}; }
  /// Stamps of the images or track frames.
  [[nodiscard]] std::vector<Timestamp> FrameStamps() const;
};

struct RecordingOptions {
  std::vector<int> cameras = {0};
  enum class Source {
    kAuto,  ///< images where all chosen cameras have them, else tracks
    kImages,
    kTracks,
    kAny,   ///< as kAuto; a recording without either is fine
    kNone,  ///< IMU and truth only
  };
  Source source = Source::kAuto;
  /// Where tracks<k> lie; empty: beside imu0.
  std::filesystem::path tracks_folder = {};
  /// Frames from this long after the first one on, for so long (0: to the end), s. IMU and truth
  /// stay whole.
  double start_s = 0.0;
  double duration_s = 0.0;
  /// Refuse an IMU gap longer than a frame within the frames' span, and truth that does not overlap
  /// it. A doctor that reports them itself switches it off.
  bool check_coverage = true;
};

/// Reads a recording; `folder` holds mav0 or is mav0. Throws InputError for whatever is wrong.
[[nodiscard]] Recording LoadRecording(const std::filesystem::path& folder,
                                      const RecordingOptions& options);

/// Writes imu0, truth and tracks<k> below `folder`/mav0 (which must not hold them yet), such that
/// LoadRecording gives the same again. Throws OutputError.
void WriteRecording(const Recording& recording, const std::filesystem::path& folder);

/// Writes tracks<k> of one camera of a stream, complete, into `folder`.
void WriteTrackFolder(const std::filesystem::path& folder, const std::vector<TrackFrameSet>& stream,
                      int camera, const CameraSensor& sensor);

}  // namespace duet
