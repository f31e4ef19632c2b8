#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "common/dataset/track_stream.h"

namespace duet {

/// SHA-256 over the canonical bytes of a stream: for each stamp in order and each camera in order
/// its stamp (int64), camera (int32) and number of observations (uint64), then for each observation
/// its track id (uint64), u and v (float32); all little-endian.
class TrackStreamHash {
 public:
  TrackStreamHash();
  ~TrackStreamHash();
  void Add(const TrackFrameSet& frames);
  [[nodiscard]] std::string Finish();

 private:
  struct State;
  std::unique_ptr<State> state_;
};
[[nodiscard]] std::string HashTrackStream(const std::vector<TrackFrameSet>& stream);

/// tracks<k>/data.csv and frames.csv (DESIGN.md section 4) as texts, frame by frame.
class TrackTableWriter {
 public:
  TrackTableWriter();
  void Add(const TrackFrame& frame);
  /// Take what has come since the last call, header lines first.
  [[nodiscard]] std::string TakeData();
  [[nodiscard]] std::string TakeFrames();

 private:
  std::string data_;
  std::string frames_;
};

/// The files of one camera's stream.
struct TrackTables {
  std::string data_csv;
  std::string data_file;  ///< name in errors
  bool has_frames_csv = false;
  std::string frames_csv;
  std::string frames_file;
};

struct TrackStream {
  std::vector<TrackFrameSet> frames;
  /// Ids that came again after they had ended, and got new ones (DESIGN.md section 4).
  std::int64_t renamed_ids = 0;
};

/// One camera's frames; `camera` is what TrackFrame::camera becomes. Observations are sorted by id.
/// InputError for an id that stands twice in a frame, and where the two tables contradict each
/// other (a truncated data.csv).
[[nodiscard]] std::vector<TrackFrame> ReadTrackTables(const TrackTables& tables, int camera);

/// The stream of all cameras by stamp. An id that was absent from one stamp (of all cameras) has
/// ended; where it comes again it gets a new one, above all others.
[[nodiscard]] TrackStream MergeTrackFrames(std::vector<std::vector<TrackFrame>> cameras);

}  // namespace duet
