#include "common/dataset/track_files.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <unordered_map>
#include <utility>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "common/support/sha256.h"

namespace duet {
namespace {

constexpr const char* kDataHeader = "#timestamp [ns],track id,u [px],v [px]\n";
constexpr const char* kFramesHeader = "#timestamp [ns],observations\n";
/// Room above every id of a file for the new ids of those that come again.
constexpr std::uint64_t kLargestId = std::numeric_limits<std::uint64_t>::max() / 2;

template <class Integer>
void AppendLittleEndian(Integer value, std::string* bytes) {
  auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < sizeof(Integer); ++i) {
    bytes->push_back(static_cast<char>(bits & 0xff));
    bits >>= 8;
  }
}

void SortById(const CsvReader& reader, TrackFrame* frame) {
  const auto by_id = [](const TrackObservation& a, const TrackObservation& b) {
    return a.track_id < b.track_id;
  };
  std::sort(frame->observations.begin(), frame->observations.end(), by_id);
  const auto twice = std::adjacent_find(frame->observations.begin(), frame->observations.end(),
                                        [](const TrackObservation& a, const TrackObservation& b) {
                                          return a.track_id == b.track_id;
                                        });
  if (twice != frame->observations.end()) {
    throw InputError(reader.file(), reader.line(), "track id",
                     "the id " + std::to_string(twice->track_id) +
                         " stands twice in the frame stamped " + std::to_string(frame->timestamp));
  }
}

std::vector<TrackFrame> ReadDataTable(const TrackTables& tables, int camera) {
  CsvReader reader(tables.data_csv, tables.data_file,
                   {{"timestamp [ns]", "track id", "u [px]", "v [px]"}});
  std::vector<TrackFrame> frames;
  while (reader.Next()) {
    const Timestamp stamp = reader.Stamp(0);
    if (frames.empty() || stamp != frames.back().timestamp) {
      reader.CheckLater(0, stamp);
      if (!frames.empty()) SortById(reader, &frames.back());
      frames.push_back({stamp, camera, {}});
    }
    const std::uint64_t id = reader.Unsigned(1);
    if (id > kLargestId) reader.Fail(1, "expected an id below 2^63");
    frames.back().observations.push_back({id, reader.Single(2), reader.Single(3)});
  }
  if (!frames.empty()) SortById(reader, &frames.back());
  // A stream without any observation is one only where frames.csv says so.
  if (!tables.has_frames_csv) reader.RequireRows();
  return frames;
}

/// The frames that frames.csv lists, with the observations of `frames`.
std::vector<TrackFrame> FillFrames(const TrackTables& tables, int camera,
                                   std::vector<TrackFrame> frames) {
  CsvReader reader(tables.frames_csv, tables.frames_file, {{"timestamp [ns]", "observations"}});
  std::vector<TrackFrame> all;
  auto next = frames.begin();
  while (reader.Next()) {
    const Timestamp stamp = reader.CheckLater(0, reader.Stamp(0));
    const std::uint64_t count = reader.Unsigned(1);
    if (next != frames.end() && next->timestamp < stamp) {
      reader.Fail(0, "the stamp " + std::to_string(next->timestamp) + " of " + tables.data_file +
                         " is missing");
    }
    all.push_back({stamp, camera, {}});
    if (next != frames.end() && next->timestamp == stamp) *(all.end() - 1) = std::move(*next++);
    if (all.back().observations.size() != count) {
      reader.Fail(1, tables.data_file + " has " + std::to_string(all.back().observations.size()) +
                         " observations of that stamp, expected " + std::to_string(count) +
                         "; is one of the files truncated?");
    }
  }
  reader.RequireRows();
  if (next != frames.end()) {
    throw InputError(
        tables.frames_file, 0, "",
        "the stamp " + std::to_string(next->timestamp) + " of " + tables.data_file + " is missing");
  }
  return all;
}

/// Gives new ids to tracks that come again after they had ended.
class Renamer {
 public:
  explicit Renamer(std::uint64_t first_new_id) : next_id_(first_new_id) {}

  void Apply(TrackFrameSet* set) {
    for (TrackFrame& frame : set->frames) {
      bool renamed = false;
      for (TrackObservation& observation : frame.observations) {
        const std::uint64_t id = NameOf(observation.track_id);
        renamed |= id != observation.track_id;
        observation.track_id = id;
      }
      if (!renamed) continue;
      std::sort(frame.observations.begin(), frame.observations.end(),
                [](const auto& a, const auto& b) { return a.track_id < b.track_id; });
    }
    ++stamp_;
  }

  [[nodiscard]] std::int64_t count() const { return count_; }

 private:
  struct Track {
    std::uint64_t name;
    std::int64_t last_stamp;
  };

  std::uint64_t NameOf(std::uint64_t id) {
    const auto [entry, is_new] = tracks_.try_emplace(id, Track{id, stamp_});
    Track& track = entry->second;
    if (!is_new && track.last_stamp + 1 < stamp_) {
      track.name = next_id_++;
      ++count_;
    }
    track.last_stamp = stamp_;
    return track.name;
  }

  std::unordered_map<std::uint64_t, Track> tracks_;  // looked up only, never walked
  std::uint64_t next_id_;
  std::int64_t stamp_ = 0;
  std::int64_t count_ = 0;
};

}  // namespace

struct TrackStreamHash::State {
  Sha256 sha256;
  std::string bytes;
};

TrackStreamHash::TrackStreamHash() : state_(std::make_unique<State>()) {}
TrackStreamHash::~TrackStreamHash() = default;

void TrackStreamHash::Add(const TrackFrameSet& frames) {
  std::string& bytes = state_->bytes;
  bytes.clear();
  for (const TrackFrame& frame : frames.frames) {
    AppendLittleEndian(frame.timestamp, &bytes);
    AppendLittleEndian(static_cast<std::int32_t>(frame.camera), &bytes);
    AppendLittleEndian(static_cast<std::uint64_t>(frame.observations.size()), &bytes);
    for (const TrackObservation& observation : frame.observations) {
      AppendLittleEndian(observation.track_id, &bytes);
      AppendLittleEndian(std::bit_cast<std::uint32_t>(observation.u), &bytes);
      AppendLittleEndian(std::bit_cast<std::uint32_t>(observation.v), &bytes);
    }
  }
  state_->sha256.Update(bytes);
}

std::string TrackStreamHash::Finish() { return state_->sha256.Finish(); }

std::string HashTrackStream(const std::vector<TrackFrameSet>& stream) {
  TrackStreamHash hash;
  for (const TrackFrameSet& frames : stream) hash.Add(frames);
  return hash.Finish();
}

TrackTableWriter::TrackTableWriter() : data_(kDataHeader), frames_(kFramesHeader) {}

void TrackTableWriter::Add(const TrackFrame& frame) {
  for (const TrackObservation& observation : frame.observations) {
    AppendNumber(frame.timestamp, &data_);
    data_.push_back(',');
    AppendNumber(observation.track_id, &data_);
    data_.push_back(',');
    AppendNumber(observation.u, &data_);
    data_.push_back(',');
    AppendNumber(observation.v, &data_);
    data_.push_back('\n');
  }
  AppendNumber(frame.timestamp, &frames_);
  frames_.push_back(',');
  AppendNumber(static_cast<std::uint64_t>(frame.observations.size()), &frames_);
  frames_.push_back('\n');
}

std::string TrackTableWriter::TakeData() { return std::exchange(data_, {}); }
std::string TrackTableWriter::TakeFrames() { return std::exchange(frames_, {}); }

std::vector<TrackFrame> ReadTrackTables(const TrackTables& tables, int camera) {
  std::vector<TrackFrame> frames = ReadDataTable(tables, camera);
  if (tables.has_frames_csv) frames = FillFrames(tables, camera, std::move(frames));
  return frames;
}

TrackStream MergeTrackFrames(std::vector<std::vector<TrackFrame>> cameras) {
  TrackStream stream;
  std::uint64_t largest_id = 0;
  std::vector<std::size_t> next(cameras.size(), 0);
  while (true) {
    TrackFrameSet set;
    set.timestamp = std::numeric_limits<Timestamp>::max();
    bool is_end = true;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      if (next[k] == cameras[k].size()) continue;
      set.timestamp = std::min(set.timestamp, cameras[k][next[k]].timestamp);
      is_end = false;
    }
    if (is_end) break;
    for (std::size_t k = 0; k < cameras.size(); ++k) {
      if (next[k] == cameras[k].size() || cameras[k][next[k]].timestamp != set.timestamp) continue;
      TrackFrame& frame = cameras[k][next[k]++];
      if (!frame.observations.empty()) {
        largest_id = std::max(largest_id, frame.observations.back().track_id);
      }
      set.frames.push_back(std::move(frame));
    }
    stream.frames.push_back(std::move(set));
  }
  Renamer renamer(largest_id + 1);
  for (TrackFrameSet& set : stream.frames) renamer.Apply(&set);
  stream.renamed_ids = renamer.count();
  return stream;
}

}  // namespace duet
