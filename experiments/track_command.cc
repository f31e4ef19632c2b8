#include <gflags/gflags.h>

#include <cstdio>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "experiments/commands.h"
#include "experiments/common_flags.h"
#include "experiments/exit_status.h"
#include "experiments/interrupt.h"
#include "experiments/overlay_window.h"
#include "experiments/progress.h"
#include "experiments/record_folder.h"
#include "experiments/session.h"
#include "frontend/overlay.h"

DEFINE_string(save_overlay, "",
              "Folder for images with the tracks drawn over them, coloured by age; must not exist "
              "yet.");
DEFINE_bool(show, false, "Show the tracks in a window while they are made.");

namespace duet {
namespace {

/// Draws what the front end sees, into files, a window or both.
class Overlay {
 public:
  Overlay() {
    if (FLAGS_show) window_.emplace();
    if (!FLAGS_save_overlay.empty()) folder_.emplace(FLAGS_save_overlay);
  }

  void Add(const TrackFrameSet& tracks, const ImageSet& images) {
    if (!window_ && !folder_) return;
    overlay_.Add(tracks);
    const cv::Mat picture = overlay_.DrawAll(images.images);
    if (window_) window_->Show(picture);
    if (folder_) {
      SaveOverlay(folder_->path() / (std::to_string(tracks.timestamp) + ".png"), picture);
    }
  }
  void Commit() {
    if (folder_) folder_->Commit();
  }

 private:
  std::optional<OverlayWindow> window_;
  std::optional<OutputFolder> folder_;
  TrackOverlay overlay_;
};

int RunTrack(const CommandLine& line) {
  RequireAbsent(FLAGS_out);
  if (!FLAGS_save_overlay.empty()) RequireAbsent(FLAGS_save_overlay);
  LogCapture log(FLAGS_quiet);
  Session session = OpenSession(line, FLAGS_dataset, "");
  if (session.recording.vision != Vision::kImages) {
    throw InputError(session.recording.folder.string(), 0, "",
                     "has no images to track (cam<k>/data.csv); its tracks can be run as they are");
  }
  RecordFolder record(FLAGS_out, line.text(), log);
  Overlay overlay;
  std::vector<TrackFrameSet> frames;
  const auto tracker = StartTracking(session, [&](const auto& tracks, const auto& images) {
    frames.push_back(tracks);
    overlay.Add(tracks, images);
  });

  Progress progress("tracking", tracker->count(), "frames", FLAGS_quiet);
  TimingLog timing;
  while (const TrackFrameSet* tracks = Interrupted() ? nullptr : tracker->Next()) {
    timing.StartFrame(tracks->timestamp);
    tracker->AddTiming(&timing);
    progress.Update(static_cast<std::int64_t>(frames.size()));
  }
  progress.Finish(Interrupted() ? "interrupted" : "");

  timing.Write(record.path() / "timing.csv");
  const std::string hash =
      WriteTracks(record.path(), session.recording, frames, session.sources.values());
  Manifest& manifest = record.manifest();
  manifest["dataset"] = DescribeRecording(session.recording);
  manifest["tracks_sha256"] = hash;
  manifest["seed"] = FLAGS_seed;
  manifest["frontend"] = DescribeTracking(*tracker, frames);
  manifest["outcome"] = {{"status", Interrupted() ? "interrupted" : "done"}};
  manifest["peak_memory_mb"] = PeakMemoryMb();
  record.Commit(session.sources);
  overlay.Commit();
  std::printf("%zu frames tracked, SHA-256 %s\n", frames.size(), hash.c_str());
  return Interrupted() ? kInterrupted : kDone;
}

}  // namespace

Command TrackCommand() {
  Command command = {
      .name = "track",
      .summary = "Runs the front end alone and writes the track stream.",
      .description =
          "Tracks points through a recording's images and writes tracks<k>/ for each camera, their "
          "SHA-256, timing.csv and a manifest. duet run and duet compare take the folder as "
          "--tracks and then need no images; the stream is the same for every estimator.",
      .example = "duet track --dataset MH_01_easy --cameras 0,1 --out tracks-mh01",
      .flags = CommonFlags(true),
      .run = RunTrack};
  command.flags.push_back({.name = "save-overlay", .value = "DIR"});
  command.flags.push_back({.name = "show"});
  return command;
}

}  // namespace duet
