#include "common/dataset/track_files.h"
#include "common/support/logging.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    duet::TrackTables tables;
    tables.data_csv = duet::TakeFirstPart(&text);
    tables.frames_csv = text;
    tables.has_frames_csv = !text.empty();
    std::vector<duet::TrackFrame> frames = duet::ReadTrackTables(tables, 0);
    duet::TrackTableWriter writer;
    for (const duet::TrackFrame& frame : frames) writer.Add(frame);
    duet::TrackTables written;
    written.data_csv = writer.TakeData();
    written.frames_csv = writer.TakeFrames();
    written.has_frames_csv = true;
    std::vector<duet::TrackFrame> again = duet::ReadTrackTables(written, 0);
    const duet::TrackStream stream = duet::MergeTrackFrames({frames, frames});
    CHECK_EQ(duet::HashTrackStream(duet::MergeTrackFrames({again, again}).frames),
             duet::HashTrackStream(stream.frames));
  });
}
