#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/dataset/track_files.h"
#include "common/support/input_error.h"
#include "common/support/random.h"
#include "common/support/sha256.h"

namespace duet {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

TrackTables Tables(const std::string& data) {
  TrackTables tables;
  tables.data_csv = data;
  tables.data_file = "tracks0/data.csv";
  return tables;
}

TrackTables Tables(const std::string& data, const std::string& frames) {
  TrackTables tables = Tables(data);
  tables.has_frames_csv = true;
  tables.frames_csv = frames;
  tables.frames_file = "tracks0/frames.csv";
  return tables;
}

std::vector<std::uint64_t> Ids(const TrackFrame& frame) {
  std::vector<std::uint64_t> ids;
  for (const TrackObservation& observation : frame.observations) {
    ids.push_back(observation.track_id);
  }
  return ids;
}

TEST(TrackTables, AreReadSortedByIdWithFloatsOfTheirText) {
  const std::vector<TrackFrame> frames =
      ReadTrackTables(Tables("#h\n10,7,1.5,2\n10,3,0.1,-3.25\n20,3,1e2,1\n"), 1);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].timestamp, 10);
  EXPECT_EQ(frames[0].camera, 1);
  EXPECT_THAT(Ids(frames[0]), ElementsAre(3, 7));
  EXPECT_EQ(frames[0].observations[0].u, 0.1F);
  EXPECT_EQ(frames[0].observations[0].v, -3.25F) << "just outside the image is valid";
}

TEST(TrackTables, FramesCsvKeepsEmptyFrames) {
  const std::vector<TrackFrame> frames =
      ReadTrackTables(Tables("10,7,1.5,2\n30,7,1,1\n",
                             "#timestamp [ns],observations\n5,0\n10,1\n20,0\n30,1\n40,0\n"),
                      0);
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_TRUE(frames[0].observations.empty());
  EXPECT_EQ(frames[1].observations.size(), 1U);
  EXPECT_EQ(frames[2].timestamp, 20);
  EXPECT_TRUE(frames[4].observations.empty());
  EXPECT_EQ(ReadTrackTables(Tables("#no observation\n", "5,0\n"), 0).size(), 1U);
}

TEST(TrackTables, WhatContradictsItselfIsRefused) {
  const auto refuses = [](const TrackTables& tables, const std::string& message) {
    EXPECT_THAT([&] { (void)ReadTrackTables(tables, 0); },
                ThrowsMessage<InputError>(HasSubstr(message)));
  };
  refuses(Tables("10,7,1,2\n10,7,3,4\n"),
          "track id: the id 7 stands twice in the frame stamped 10");
  refuses(Tables("10,7,1,2\n20,7,1,2\n10,8,3,4\n"), "time goes backwards");
  refuses(Tables("10,7,1,nan\n"), "data.csv:1: v [px]: expected a finite number, got 'nan'");
  refuses(Tables("10,-7,1,2\n"), "data.csv:1: track id: expected an integer of at least 0");
  refuses(Tables("10,9223372036854775808,1,2\n"), "expected an id below 2^63");
  refuses(Tables("#h\n"), "has no rows");
  refuses(Tables("10,7,1,2\n", "10,2\n"),
          "tracks0/frames.csv:1: observations: tracks0/data.csv has 1 observations of that stamp, "
          "expected 2; is one of the files truncated?");
  refuses(Tables("10,7,1,2\n", "20,0\n"), "frames.csv:1: timestamp [ns]: the stamp 10 of");
  refuses(Tables("10,7,1,2\n20,7,1,2\n", "10,1\n"), "frames.csv: the stamp 20 of tracks0/data.csv");
  refuses(Tables("10,7,1,2\n", "10,1\n10,1\n"), "stands twice");
}

TEST(TrackStream, PairsCamerasByStamp) {
  const TrackStream stream =
      MergeTrackFrames({{{10, 0, {{1, 1, 1}}}, {20, 0, {{1, 1, 1}}}, {30, 0, {}}},
                        {{10, 1, {{1, 2, 2}}}, {30, 1, {{1, 2, 2}}}, {40, 1, {{1, 2, 2}}}}});
  ASSERT_EQ(stream.frames.size(), 4U);
  EXPECT_EQ(stream.frames[0].frames.size(), 2U);
  EXPECT_EQ(stream.frames[1].frames.size(), 1U);
  EXPECT_EQ(stream.frames[2].frames.at(1).camera, 1);
  EXPECT_EQ(stream.frames[3].timestamp, 40);
  EXPECT_EQ(stream.renamed_ids, 0) << "seen by one camera at every stamp";
}

TEST(TrackStream, AnIdThatComesAgainIsAnother) {
  // 5 is away at 20 and comes again at 30, and once more at 50; 9 stays.
  const TrackStream stream = MergeTrackFrames({{{10, 0, {{5, 1, 1}, {9, 2, 2}}},
                                                {20, 0, {{9, 2, 2}}},
                                                {30, 0, {{5, 3, 3}, {9, 2, 2}}},
                                                {40, 0, {{9, 2, 2}}},
                                                {50, 0, {{5, 4, 4}, {9, 2, 2}}},
                                                {60, 0, {{5, 5, 5}, {9, 2, 2}}}}});
  EXPECT_EQ(stream.renamed_ids, 2);
  EXPECT_THAT(Ids(stream.frames[0].frames[0]), ElementsAre(5, 9));
  EXPECT_THAT(Ids(stream.frames[2].frames[0]), ElementsAre(9, 10)) << "sorted by its new id";
  EXPECT_EQ(stream.frames[2].frames[0].observations[1].u, 3.0F);
  EXPECT_THAT(Ids(stream.frames[4].frames[0]), ElementsAre(9, 11));
  EXPECT_THAT(Ids(stream.frames[5].frames[0]), ElementsAre(9, 11)) << "it goes on under that id";
}

TEST(TrackStream, AnEmptyFrameEndsEveryTrack) {
  const TrackStream stream =
      MergeTrackFrames({{{10, 0, {{5, 1, 1}}}, {20, 0, {}}, {30, 0, {{5, 1, 1}}}}});
  EXPECT_EQ(stream.renamed_ids, 1);
  EXPECT_THAT(Ids(stream.frames[2].frames[0]), ElementsAre(6));
}

TEST(TrackStream, BothCamerasGetTheSameNewId) {
  const TrackStream stream =
      MergeTrackFrames({{{10, 0, {{5, 1, 1}}}, {20, 0, {{6, 1, 1}}}, {30, 0, {{5, 1, 1}}}},
                        {{10, 1, {{5, 1, 1}}}, {20, 1, {}}, {30, 1, {{5, 1, 1}}}}});
  EXPECT_EQ(stream.renamed_ids, 1);
  EXPECT_THAT(Ids(stream.frames[2].frames[0]), ElementsAre(7));
  EXPECT_THAT(Ids(stream.frames[2].frames[1]), ElementsAre(7));
}

std::vector<TrackFrame> RandomFrames(int camera) {
  Random random(static_cast<std::uint64_t>(camera));
  std::vector<TrackFrame> frames;
  for (int i = 0; i < 40; ++i) {
    TrackFrame& frame = frames.emplace_back();
    frame.timestamp = 1403636583763555584 + i * 50000003LL;
    frame.camera = camera;
    if (i % 7 == 3) continue;  // an empty frame
    for (std::uint64_t id = 0; id < 20; ++id) {
      frame.observations.push_back({100 * static_cast<std::uint64_t>((i + 3) / 7) + id,
                                    static_cast<float>(752 * random.Uniform()),
                                    static_cast<float>(480 * random.Uniform())});
    }
  }
  return frames;
}

TEST(TrackStream, WhatIsWrittenReadsBackToTheSameHash) {
  std::vector<std::vector<TrackFrame>> cameras = {RandomFrames(0), RandomFrames(1)};
  std::vector<std::vector<TrackFrame>> again;
  for (int k = 0; k < 2; ++k) {
    TrackTableWriter writer;
    for (const TrackFrame& frame : cameras[static_cast<std::size_t>(k)]) writer.Add(frame);
    again.push_back(ReadTrackTables(Tables(writer.TakeData(), writer.TakeFrames()), k));
  }
  const std::string hash = HashTrackStream(MergeTrackFrames(cameras).frames);
  EXPECT_EQ(HashTrackStream(MergeTrackFrames(again).frames), hash);
  EXPECT_EQ(MergeTrackFrames(again).renamed_ids, 0);

  cameras[1][5].observations[3].u = std::nextafter(cameras[1][5].observations[3].u, 1e9F);
  EXPECT_NE(HashTrackStream(MergeTrackFrames(cameras).frames), hash) << "one bit matters";
}

TEST(TrackStream, TheHashIsOfTheDocumentedBytes) {
  // stamp 1, camera 0, one observation of id 2 at (1, -2): by hand.
  const std::string bytes(
      "\x01\0\0\0\0\0\0\0"
      "\0\0\0\0"
      "\x01\0\0\0\0\0\0\0"
      "\x02\0\0\0\0\0\0\0"
      "\0\0\x80\x3f"
      "\0\0\0\xc0",
      36);
  EXPECT_EQ(HashTrackStream({{1, {{1, 0, {{2, 1.0F, -2.0F}}}}}}), Sha256Hex(bytes));
}

TEST(TrackTables, AreWrittenAsDocumented) {
  TrackTableWriter writer;
  writer.Add({10, 0, {{2, 0.1F, 3.0F}}});
  writer.Add({20, 0, {}});
  EXPECT_EQ(writer.TakeData(), "#timestamp [ns],track id,u [px],v [px]\n10,2,0.1,3\n");
  EXPECT_EQ(writer.TakeFrames(), "#timestamp [ns],observations\n10,1\n20,0\n");
  writer.Add({30, 0, {{2, 1.0F, 1.0F}}});
  EXPECT_EQ(writer.TakeData(), "30,2,1,1\n") << "what has come since";
}

}  // namespace
}  // namespace duet
