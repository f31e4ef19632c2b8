// The front end, one frame an iteration, images in memory: on rendered images (752 x 480) and,
// where the recording is there, on real ones. One thread.

#include <benchmark/benchmark.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "common/dataset/recording.h"
#include "frontend/frontend.h"
#include "frontend/image_source.h"
#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

struct Sequence {
  RigCalibration rig;
  std::vector<ImageSet> images;
  std::vector<ImuSample> imu;
};

CameraModel EurocCamera() {
  CameraModel::Parameters parameters(9);
  parameters << 458.7, 457.3, 367.2, 248.4, -0.283, 0.0740, 1.9e-4, 1.8e-5, 0.0;
  return {DistortionModel::kRadialTangential, 752, 480, parameters};
}

// 30 frames of a rig that sways in front of a wall.
Sequence Rendered(bool stereo) {
  constexpr Timestamp kFrame = 50'000'000;
  Sequence sequence;
  sequence.rig = SmallRig(stereo);
  for (CameraCalibration& camera : sequence.rig.cameras) camera.model = EurocCamera();
  const SyntheticScene scene(1);
  const Eigen::Vector3d omega_B(0.1, 0.05, 0.3);
  for (int frame = 0; frame < 30; ++frame) {
    const double t_s = 0.05 * frame;
    const Pose T_GB{ExpQuaternion((t_s - 0.75) * omega_B),
                    {0.4 * std::sin(1.3 * t_s), 0.3 * std::sin(1.9 * t_s), 0.1 * std::sin(t_s)}};
    ImageSet set;
    set.timestamp = frame * kFrame;
    for (std::size_t camera = 0; camera < sequence.rig.cameras.size(); ++camera) {
      set.images.push_back(
          scene.Render(sequence.rig.cameras[camera].model, CameraPose(sequence.rig, camera, T_GB)));
    }
    sequence.images.push_back(std::move(set));
    for (int i = 0; i < 10; ++i) {
      sequence.imu.push_back({frame * kFrame + i * kFrame / 10, omega_B, {0, 0, 9.81}});
    }
  }
  return sequence;
}

// The first 5 s of the clip; nothing where it is not there.
Sequence Recorded(bool stereo) {
  const char* told = std::getenv("DUET_DATA");
  const fs::path data =
      told != nullptr ? fs::path(told)
                      : fs::path(__FILE__).parent_path().parent_path().parent_path().parent_path() /
                            "shared/data";
  const fs::path folder = data / "euroc/MH_01_easy_05s";
  if (!fs::exists(folder)) return {};
  RecordingOptions options;
  options.cameras = stereo ? std::vector<int>{0, 1} : std::vector<int>{0};
  options.source = RecordingOptions::Source::kImages;
  options.duration_s = 5.0;
  const Recording recording = LoadRecording(folder, options);
  Sequence sequence{.rig = recording.rig, .images = {}, .imu = recording.imu};
  std::vector<ImageFiles> files;
  for (const ImageStamp& stamp : recording.images) files.push_back({stamp.timestamp, stamp.paths});
  ImageSource source(std::move(files), recording.rig);
  while (std::optional<ImageSet> set = source.Next()) sequence.images.push_back(std::move(*set));
  return sequence;
}

void TrackFrames(benchmark::State& state, const Sequence& sequence) {
  if (sequence.images.empty()) {
    state.SkipWithError("no recording: neither DUET_DATA nor ../shared/data beside the repository");
    return;
  }
  const int max_tracks = static_cast<int>(state.range(0));
  std::unique_ptr<Frontend> frontend;
  std::size_t frame = sequence.images.size();
  std::size_t sample = 0;
  std::int64_t observations = 0;
  for (auto _ : state) {
    if (frame == sequence.images.size()) {
      // A new pass; its first frame, which has nothing to track, is not counted.
      state.PauseTiming();
      frontend = std::make_unique<Frontend>(FrontendOptions{}, max_tracks, sequence.rig);
      (void)frontend->Process(sequence.images[0].timestamp, sequence.images[0].images);
      frame = 1;
      sample = 0;
      state.ResumeTiming();
    }
    const ImageSet& set = sequence.images[frame++];
    while (sample < sequence.imu.size() && sequence.imu[sample].timestamp <= set.timestamp) {
      frontend->AddImu(sequence.imu[sample++]);
    }
    const TrackFrameSet& tracks = frontend->Process(set.timestamp, set.images);
    observations += static_cast<std::int64_t>(tracks.frames[0].observations.size());
  }
  state.counters["tracks"] =
      benchmark::Counter(static_cast<double>(observations), benchmark::Counter::kAvgIterations);
}

void RenderedMono(benchmark::State& state) {
  static const Sequence sequence = Rendered(false);
  TrackFrames(state, sequence);
}
void RenderedStereo(benchmark::State& state) {
  static const Sequence sequence = Rendered(true);
  TrackFrames(state, sequence);
}
void RecordedMono(benchmark::State& state) {
  static const Sequence sequence = Recorded(false);
  TrackFrames(state, sequence);
}
void RecordedStereo(benchmark::State& state) {
  static const Sequence sequence = Recorded(true);
  TrackFrames(state, sequence);
}
BENCHMARK(RenderedMono)->Arg(150)->Arg(300)->Unit(benchmark::kMillisecond);
BENCHMARK(RenderedStereo)->Arg(150)->Unit(benchmark::kMillisecond);
BENCHMARK(RecordedMono)->Arg(150)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK(RecordedStereo)->Arg(150)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace duet

BENCHMARK_MAIN();
