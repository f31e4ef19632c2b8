#include "experiments/record_folder.h"

#include <algorithm>

#include "common/support/input_error.h"
#include "common/support/sha256.h"
#include "common/support/text_file.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

/// Over the settings that decide about the tracks: the number of threads does not.
std::string HashTrackingSettings(const std::vector<ResolvedValue>& settings) {
  std::string text;
  for (const ResolvedValue& setting : settings) {
    const bool counts =
        setting.key.rfind("frontend.", 0) == 0 || setting.key == "shared.max_tracks";
    if (!counts || setting.key == "frontend.threads") continue;
    text += setting.key + ": " + setting.value + "\n";
  }
  return Sha256Hex(text);
}

}  // namespace

void RequireAbsent(const std::string& out) {
  std::error_code ignored;
  if (fs::exists(fs::symlink_status(out, ignored))) {
    throw InputError(out, 0, "", "exists; --out expects a folder that does not exist yet");
  }
}

RecordFolder::RecordFolder(const std::string& out, const std::string& command_line,
                           const LogCapture& log, OutputFolder::Makers makers)
    : log_(log), manifest_(StartManifest(command_line)), folder_(out, makers) {}

void RecordFolder::Commit(const ConfigSources& sources) {
  WriteRest(sources);
  folder_.Commit();
}

void RecordFolder::WriteRest(const ConfigSources& sources) {
  manifest_["settings_sha256"] = sources.SettingsSha256();
  if (!manifest_.contains("warnings")) manifest_["warnings"] = Manifest::array();
  for (const std::string& warning : log_.warnings()) manifest_["warnings"].push_back(warning);
  WriteTextFile(path() / "config.yaml", sources.ResolvedYaml());
  WriteTextFile(path() / "log.txt", log_.text());
  WriteManifest(manifest_, path());
}

Manifest DescribeRecording(const Recording& recording) {
  const std::vector<Timestamp> stamps = recording.FrameStamps();
  Manifest dataset = {{"path", recording.folder.string()},
                      {"fingerprint_sha256", recording.fingerprint},
                      {"cameras", recording.camera_numbers},
                      {"frames", stamps.size()}};
  if (!recording.label.empty()) dataset["label"] = recording.label;
  if (!stamps.empty()) {
    dataset["first_frame_ns"] = stamps.front();
    dataset["last_frame_ns"] = stamps.back();
  }
  return dataset;
}

Manifest DescribeTracking(const LiveTracker& tracker, const std::vector<TrackFrameSet>& frames) {
  std::size_t observations = 0;
  std::size_t images = 0;
  for (const TrackFrameSet& set : frames) {
    for (const TrackFrame& frame : set.frames) observations += frame.observations.size();
    images += set.frames.size();
  }
  const FrontendCounts& total = tracker.statistics().total;
  Manifest dropped = Manifest::array();
  for (const DroppedImage& image : tracker.dropped()) dropped.push_back(image.path);
  return {{"frames", tracker.statistics().frames},
          {"mean_tracks", static_cast<double>(observations) /
                              static_cast<double>(std::max<std::size_t>(images, 1))},
          {"dropped_images", dropped},
          {"tracks",
           {{"kept", total.kept},
            {"detected", total.detected},
            {"lost_flow", total.lost_flow},
            {"lost_backward", total.lost_backward},
            {"lost_outlier", total.lost_outlier},
            {"lost_crowded", total.lost_crowded},
            {"stereo_matched", total.stereo_matched},
            {"stereo_unmatched", total.stereo_unmatched}}}};
}

std::string WriteTracks(const fs::path& folder, const Recording& recording,
                        const std::vector<TrackFrameSet>& frames,
                        const std::vector<ResolvedValue>& settings) {
  for (std::size_t k = 0; k < recording.camera_sensors.size(); ++k) {
    CameraSensor sensor = recording.camera_sensors[k];
    sensor.frontend_settings_sha256 = HashTrackingSettings(settings);
    sensor.image_set_sha256 = recording.fingerprint;
    WriteTrackFolder(folder / ("tracks" + std::to_string(recording.camera_numbers[k])), frames,
                     static_cast<int>(k), sensor);
  }
  std::string hash = HashTrackStream(frames);
  WriteTextFile(folder / "tracks.sha256", hash + "\n");
  return hash;
}

}  // namespace duet
