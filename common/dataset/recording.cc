#include "common/dataset/recording.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "common/dataset/asl_tables.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

class Loader {
 public:
  Loader(const fs::path& folder, const RecordingOptions& options) : options_(options) {
    recording_.folder = FindMav(folder);
  }

  Recording Load() {
    ReadLabel();
    ReadImu();
    ReadVision();
    ReadTruth();
    TrimFrames();
    for (const std::string& key : unknown_keys_) {
      recording_.warnings.push_back(key + ": unknown key, passed over");
    }
    if (options_.check_coverage) CheckCoverage();
    recording_.fingerprint = fingerprint_.Finish();
    return std::move(recording_);
  }

 private:
  static fs::path FindMav(const fs::path& folder) {
    if (!fs::exists(folder)) {
      throw InputError(folder.string(), 0, "", "no such folder; expected a recording (mav0)");
    }
    for (const fs::path& candidate : {folder / "mav0", folder}) {
      if (fs::exists(candidate / "imu0")) return candidate;
    }
    throw InputError(folder.string(), 0, "", "is no recording: expected mav0 with imu0 in it");
  }

  /// Reads a file and lets it enter the fingerprint by its name within the recording.
  std::string Read(const fs::path& path) {
    std::string text = ReadTextFile(path);
    const std::string name =
        path.parent_path().filename().string() + "/" + path.filename().string();
    fingerprint_.Update(name + "\n" + std::to_string(text.size()) + "\n");
    fingerprint_.Update(text);
    return text;
  }

  void ReadLabel() {
    const fs::path path = recording_.folder / "recording.yaml";
    if (!fs::exists(path)) return;
    const YamlNode root = ParseYaml(Read(path), path.string());
    YamlMap map(root, path.string());
    recording_.label = map.Text("label");
    for (const std::string& key : map.UnknownKeys())
      unknown_keys_.push_back("recording.yaml: " + key);
  }

  void ReadImu() {
    const fs::path folder = recording_.folder / "imu0";
    const fs::path sensor = folder / "sensor.yaml";
    recording_.imu_sensor = ReadImuSensor(Read(sensor), sensor.string(), &unknown_keys_);
    recording_.imu = ReadImuTable(Read(folder / "data.csv"), (folder / "data.csv").string());
  }

  fs::path CameraFolder(int number) const {
    return recording_.folder / ("cam" + std::to_string(number));
  }
  fs::path TracksFolder(int number) const {
    const fs::path& parent =
        options_.tracks_folder.empty() ? recording_.folder : options_.tracks_folder;
    return parent / ("tracks" + std::to_string(number));
  }

  void ReadVision() {
    using Source = RecordingOptions::Source;
    if (options_.source == Source::kNone) return;
    const auto all_have = [this](fs::path (Loader::*folder)(int) const) {
      return std::all_of(options_.cameras.begin(), options_.cameras.end(), [&](int number) {
        return fs::exists((this->*folder)(number) / "data.csv");
      });
    };
    const bool has_images = all_have(&Loader::CameraFolder);
    const bool has_tracks = all_have(&Loader::TracksFolder);
    if (options_.source == Source::kImages || (has_images && options_.source != Source::kTracks)) {
      recording_.vision = Vision::kImages;
    } else if (options_.source == Source::kTracks || has_tracks) {
      recording_.vision = Vision::kTracks;
    } else if (options_.source == Source::kAny) {
      return;
    } else {
      FailWithoutVision();
    }
    ReadCameraSensors();
    if (recording_.vision == Vision::kImages) {
      ReadImages();
    } else {
      ReadTracks();
    }
  }

  [[noreturn]] void FailWithoutVision() const {
    for (const int number : options_.cameras) {
      if (fs::exists(CameraFolder(number) / "data.csv")) continue;
      if (fs::exists(TracksFolder(number) / "data.csv")) continue;
      throw InputError(recording_.folder.string(), 0, "",
                       "has neither images (cam" + std::to_string(number) +
                           "/data.csv) nor tracks (" + TracksFolder(number).string() +
                           "/data.csv) of camera " + std::to_string(number));
    }
    throw InputError(recording_.folder.string(), 0, "",
                     "has images of some of the chosen cameras and tracks of others; expected one "
                     "kind for all");
  }

  void ReadCameraSensors() {
    for (const int number : options_.cameras) {
      const fs::path folder =
          recording_.vision == Vision::kImages ? CameraFolder(number) : TracksFolder(number);
      if (!fs::is_directory(folder)) {
        throw InputError(folder.string(), 0, "", "no such folder");
      }
      const fs::path file = folder / "sensor.yaml";
      recording_.camera_sensors.push_back(
          ReadCameraSensor(Read(file), file.string(), &unknown_keys_));
      recording_.camera_numbers.push_back(number);
    }
    recording_.rig = MakeRig(recording_.imu_sensor.calibration, recording_.camera_sensors,
                             recording_.folder.string());
  }

  void ReadImages() {
    std::vector<std::vector<ImageName>> tables;
    for (const int number : options_.cameras) {
      const fs::path folder = CameraFolder(number);
      tables.push_back(ReadImageTable(Read(folder / "data.csv"), (folder / "data.csv").string()));
      for (const ImageName& image : tables.back()) {
        std::error_code missing;
        const std::uintmax_t size = fs::file_size(folder / "data" / image.name, missing);
        fingerprint_.Update(image.name + (missing ? " -" : " " + std::to_string(size)) + "\n");
      }
    }
    PairImages(tables);
  }

  /// Stamps that all cameras have; those inside their common span that one lacks are counted.
  void PairImages(const std::vector<std::vector<ImageName>>& tables) {
    Timestamp first = 0;
    Timestamp last = std::numeric_limits<Timestamp>::max();
    std::vector<Timestamp> stamps;
    for (const std::vector<ImageName>& table : tables) {
      first = std::max(first, table.front().timestamp);
      last = std::min(last, table.back().timestamp);
      for (const ImageName& image : table) stamps.push_back(image.timestamp);
    }
    std::sort(stamps.begin(), stamps.end());
    stamps.erase(std::unique(stamps.begin(), stamps.end()), stamps.end());
    std::vector<std::size_t> next(tables.size(), 0);
    for (const Timestamp stamp : stamps) {
      ImageStamp images{stamp, {}};
      for (std::size_t k = 0; k < tables.size(); ++k) {
        if (next[k] == tables[k].size() || tables[k][next[k]].timestamp != stamp) continue;
        const std::string& name = tables[k][next[k]++].name;
        images.paths.push_back((CameraFolder(options_.cameras[k]) / "data" / name).string());
      }
      if (images.paths.size() == tables.size()) {
        recording_.images.push_back(std::move(images));
      } else if (stamp >= first && stamp <= last) {
        ++recording_.unpaired_images;
      }
    }
    if (recording_.images.empty()) {
      throw InputError(recording_.folder.string(), 0, "",
                       "the chosen cameras have no stamp in common; expected images taken together "
                       "to have equal stamps");
    }
    if (recording_.unpaired_images > 0) {
      recording_.warnings.push_back(std::to_string(recording_.unpaired_images) +
                                    " stamps of images lack one of the chosen cameras");
    }
  }

  void ReadTracks() {
    std::vector<std::vector<TrackFrame>> cameras;
    for (const int number : options_.cameras) {
      const fs::path folder = TracksFolder(number);
      TrackTables tables;
      tables.data_file = (folder / "data.csv").string();
      tables.data_csv = Read(folder / "data.csv");
      tables.has_frames_csv = fs::exists(folder / "frames.csv");
      if (tables.has_frames_csv) {
        tables.frames_file = (folder / "frames.csv").string();
        tables.frames_csv = Read(folder / "frames.csv");
      }
      cameras.push_back(ReadTrackTables(tables, static_cast<int>(cameras.size())));
    }
    recording_.tracks = MergeTrackFrames(std::move(cameras));
    if (recording_.tracks.renamed_ids > 0) {
      recording_.warnings.push_back(std::to_string(recording_.tracks.renamed_ids) +
                                    " track ids came again after they had ended, and got new ones");
    }
  }

  void ReadTruth() {
    for (const char* name : {"state_groundtruth_estimate0", "mocap0", "vicon0"}) {
      const fs::path folder = recording_.folder / name;
      const fs::path file = folder / "data.csv";
      if (!fs::exists(file)) continue;
      recording_.truth_file = file.string();
      recording_.truth = ReadGroundTruthTable(Read(file), file.string());
      if (fs::exists(folder / "sensor.yaml")) MoveToBody(folder / "sensor.yaml");
      return;
    }
  }

  /// A motion-capture system tells the pose of its marker: T_GB = T_GS T_BS^-1.
  void MoveToBody(const fs::path& sensor_file) {
    const Pose T_SB = ReadSensorPose(Read(sensor_file), sensor_file.string()).Inverse();
    if (T_SB.p.norm() < 1e-12 && T_SB.R.vec().norm() < 1e-12) return;
    if (recording_.truth->has_velocities() || recording_.truth->has_biases()) {
      throw InputError(sensor_file.string(), 0, "T_BS",
                       "expected the identity for truth with velocities or biases");
    }
    for (StampedPose& pose : recording_.truth->poses) pose.T_GB = pose.T_GB * T_SB;
  }

  void TrimFrames() {
    // Far beyond any recording, and small enough to be added to a stamp.
    constexpr double kLongest_s = 1e9;
    if (!(options_.start_s >= 0.0 && options_.start_s < kLongest_s && options_.duration_s >= 0.0 &&
          options_.duration_s < kLongest_s)) {
      throw InputError("", 0, "start, duration", "expected seconds of at least 0");
    }
    const std::vector<Timestamp> stamps = recording_.FrameStamps();
    if (stamps.empty() || (options_.start_s <= 0.0 && options_.duration_s <= 0.0)) return;
    const Timestamp begin = stamps.front() + ToNanoseconds(options_.start_s);
    const Timestamp end = options_.duration_s > 0.0 ? begin + ToNanoseconds(options_.duration_s)
                                                    : std::numeric_limits<Timestamp>::max();
    const auto is_outside = [&](const auto& frame) {
      return frame.timestamp < begin || frame.timestamp > end;
    };
    std::erase_if(recording_.images, is_outside);
    std::erase_if(recording_.tracks.frames, is_outside);
    if (recording_.FrameStamps().empty()) {
      throw InputError(recording_.folder.string(), 0, "",
                       "has no frame in the span asked for (from " +
                           FormatNumber(options_.start_s) + " s on); the recording has " +
                           FormatDuration(stamps.back() - stamps.front()) + " s of frames");
    }
  }

  void CheckCoverage() const {
    const std::vector<Timestamp> frames = recording_.FrameStamps();
    if (frames.empty()) return;
    const std::string imu_file = (recording_.folder / "imu0" / "data.csv").string();
    const std::vector<ImuSample>& imu = recording_.imu;
    if (imu.back().timestamp <= frames.front() || imu.front().timestamp >= frames.back()) {
      throw InputError(imu_file, 0, "", "does not overlap the frames in time");
    }
    CheckImuGaps(imu_file, frames);
    if (recording_.truth && (recording_.truth->poses.back().timestamp < frames.front() ||
                             recording_.truth->poses.front().timestamp > frames.back())) {
      throw InputError(recording_.truth_file, 0, "", "does not overlap the frames in time");
    }
  }

  /// An IMU gap longer than a frame leaves a frame's interval without a single sample.
  void CheckImuGaps(const std::string& file, const std::vector<Timestamp>& frames) const {
    if (frames.size() < 2) return;
    std::vector<Timestamp> steps;
    for (std::size_t i = 1; i < frames.size(); ++i) steps.push_back(frames[i] - frames[i - 1]);
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                     steps.end());
    const Timestamp frame_step = steps[steps.size() / 2];
    for (std::size_t i = 1; i < recording_.imu.size(); ++i) {
      const Timestamp start = recording_.imu[i - 1].timestamp;
      const Timestamp end = recording_.imu[i].timestamp;
      if (end <= frames.front() || start >= frames.back() || end - start <= frame_step) continue;
      throw InputError(file, 0, "timestamp [ns]",
                       "gap of " + FormatDuration(end - start) + " s after " +
                           std::to_string(start) + "; expected at most the time between frames, " +
                           FormatDuration(frame_step) + " s");
    }
  }

  RecordingOptions options_;
  Recording recording_;
  Sha256 fingerprint_;
  std::vector<std::string> unknown_keys_;
};

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder.parent_path(), error);
  if (!error && !fs::create_directory(folder, error) && !error) {
    throw OutputError(folder.string(), "exists");
  }
  if (error) throw OutputError(folder.string(), "cannot be made: " + error.message());
}

}  // namespace

std::vector<Timestamp> Recording::FrameStamps() const {
  std::vector<Timestamp> stamps;
  for (const ImageStamp& image : images) stamps.push_back(image.timestamp);
  for (const TrackFrameSet& set : tracks.frames) stamps.push_back(set.timestamp);
  return stamps;
}

Recording LoadRecording(const fs::path& folder, const RecordingOptions& options) {
  try {
    return Loader(folder, options).Load();
  } catch (const fs::filesystem_error& error) {  // a folder that may not be searched
    throw InputError(error.path1().string(), 0, "", error.code().message());
  }
}

void WriteTrackFolder(const fs::path& folder, const std::vector<TrackFrameSet>& stream, int camera,
                      const CameraSensor& sensor) {
  MakeFolder(folder);
  TrackTableWriter tables;
  for (const TrackFrameSet& set : stream) {
    for (const TrackFrame& frame : set.frames) {
      if (frame.camera == camera) tables.Add(frame);
    }
  }
  WriteTextFile(folder / "data.csv", tables.TakeData());
  WriteTextFile(folder / "frames.csv", tables.TakeFrames());
  WriteTextFile(folder / "sensor.yaml", WriteCameraSensor(sensor));
}

void WriteRecording(const Recording& recording, const fs::path& folder) {
  const fs::path mav = folder / "mav0";
  MakeFolder(mav / "imu0");
  WriteTextFile(mav / "imu0" / "data.csv", WriteImuTable(recording.imu));
  WriteTextFile(mav / "imu0" / "sensor.yaml", WriteImuSensor(recording.imu_sensor));
  if (!recording.label.empty()) {
    WriteTextFile(mav / "recording.yaml", "label: " + QuotedYaml(recording.label) + "\n");
  }
  if (recording.truth) {
    const fs::path truth = mav / "state_groundtruth_estimate0";
    MakeFolder(truth);
    WriteTextFile(truth / "data.csv", WriteGroundTruthTable(*recording.truth));
  }
  if (recording.vision != Vision::kTracks) return;
  for (std::size_t k = 0; k < recording.camera_sensors.size(); ++k) {
    WriteTrackFolder(mav / ("tracks" + std::to_string(recording.camera_numbers.at(k))),
                     recording.tracks.frames, static_cast<int>(k), recording.camera_sensors[k]);
  }
}

}  // namespace duet
