#include "experiments/simulation/render/render_recording.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

#include "common/dataset/asl_sensors.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "experiments/simulation/render/image_writer.h"
#include "experiments/simulation/render/renderer.h"
#include "experiments/simulation/write_recording.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr double kMaxEmptyShare = 0.5;

fs::path CameraFolder(const fs::path& mav, std::size_t camera) {
  return mav / ("cam" + std::to_string(camera));
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder.string(), "cannot be made: " + error.message());
}

void CheckView(const SimulatedRecording& recording, Timestamp stamp, double empty_share) {
  if (empty_share <= kMaxEmptyShare) return;
  throw InputError("", 0, "world",
                   FormatNumber(std::round(100.0 * empty_share)) + " % of the view is empty at " +
                       FormatNumber(SecondsBetween(recording.start, stamp)) +
                       " s; expected a path on which the cameras see the world");
}

}  // namespace

RenderReport RenderRecording(const SimulatedRecording& recording,
                             std::shared_ptr<const World> world, const RenderOptions& options,
                             const fs::path& mav, const std::function<bool(int done)>& progress) {
  const Recording told = ToRecording(recording);
  const std::size_t cameras = told.camera_sensors.size();
  for (std::size_t k = 0; k < cameras; ++k) MakeFolder(CameraFolder(mav, k) / "data");
  const Renderer renderer(options, TrueCamera(recording.true_rig, std::move(world),
                                              recording.trajectory, recording.start));
  ImageWriter writer(options.threads);
  RenderReport report;
  std::string table = "#timestamp [ns],filename\n";
  for (const TrackFrameSet& set : recording.frames) {
    const std::string name = std::to_string(set.timestamp) + ".png";
    table += std::to_string(set.timestamp) + "," + name + "\n";
    for (std::size_t k = 0; k < cameras; ++k) {
      const RenderedImage rendered = renderer.Render(static_cast<int>(k), set.timestamp);
      CheckView(recording, set.timestamp, rendered.empty_share);
      report.largest_empty_share = std::max(report.largest_empty_share, rendered.empty_share);
      writer.Write(rendered.image, CameraFolder(mav, k) / "data" / name);
      ++report.images;
    }
    if (!progress(report.images)) return report;
  }
  writer.Finish();
  for (std::size_t k = 0; k < cameras; ++k) {
    WriteTextFile(CameraFolder(mav, k) / "data.csv", table);
    WriteTextFile(CameraFolder(mav, k) / "sensor.yaml", WriteCameraSensor(told.camera_sensors[k]));
  }
  return report;
}

}  // namespace duet
