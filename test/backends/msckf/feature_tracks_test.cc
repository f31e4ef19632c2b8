// The bookkeeping of tracks: every observation is held once, until it is used or its clone goes.

#include "backends/msckf/feature_tracks.h"

#include <gtest/gtest.h>

namespace duet {
namespace {

TrackFrameSet Frames(std::vector<std::vector<std::uint64_t>> ids) {
  TrackFrameSet set;
  for (std::size_t c = 0; c < ids.size(); ++c) {
    TrackFrame frame;
    frame.camera = static_cast<int>(c);
    for (const std::uint64_t id : ids[c]) {
      frame.observations.push_back({id, static_cast<float>(id), static_cast<float>(c)});
    }
    set.frames.push_back(frame);
  }
  return set;
}

std::vector<std::uint64_t> Ids(const FeatureTracks& tracks) {
  std::vector<std::uint64_t> ids;
  for (int i = 0; i < tracks.size(); ++i) ids.push_back(tracks[i].track_id);
  return ids;
}

TEST(FeatureTracks, MergesCamerasInAscendingOrderOfId) {
  FeatureTracks tracks;
  EXPECT_EQ(tracks.Add(Frames({{1, 4, 9}, {4, 7}}), 0), 5);
  EXPECT_EQ(Ids(tracks), (std::vector<std::uint64_t>{1, 4, 7, 9}));
  ASSERT_EQ(tracks[1].observations.size(), 2U);
  EXPECT_EQ(tracks[1].observations[0].camera, 0);
  EXPECT_EQ(tracks[1].observations[1].camera, 1);
  EXPECT_EQ(tracks[2].observations[0].camera, 1);
}

TEST(FeatureTracks, ATrackThatNoCameraSawHasEnded) {
  FeatureTracks tracks;
  tracks.Add(Frames({{1, 2, 3}, {1}}), 0);
  tracks.Add(Frames({{2, 5}, {3}}), 1);
  EXPECT_EQ(Ids(tracks), (std::vector<std::uint64_t>{1, 2, 3, 5}));
  EXPECT_FALSE(tracks[0].alive);
  EXPECT_TRUE(tracks[1].alive);
  EXPECT_TRUE(tracks[2].alive);  // the other camera still sees it
  tracks.RemoveEnded();
  EXPECT_EQ(Ids(tracks), (std::vector<std::uint64_t>{2, 3, 5}));
}

TEST(FeatureTracks, AnEmptyFrameEndsAll) {
  FeatureTracks tracks;
  tracks.Add(Frames({{1, 2}}), 0);
  EXPECT_EQ(tracks.Add(Frames({{}}), 1), 0);
  for (int i = 0; i < tracks.size(); ++i) EXPECT_FALSE(tracks[i].alive);
  tracks.RemoveEnded();
  EXPECT_EQ(tracks.size(), 0);
}

TEST(FeatureTracks, WhatIsConsumedIsNotSeenAgainAndTheTrackGoesOn) {
  FeatureTracks tracks;
  tracks.Add(Frames({{3}}), 0);
  tracks.Add(Frames({{3}}), 1);
  tracks.Consume(0);
  EXPECT_TRUE(tracks[0].observations.empty());
  tracks.Add(Frames({{3}}), 2);
  ASSERT_EQ(tracks[0].observations.size(), 1U);
  EXPECT_EQ(tracks[0].observations[0].clone_id, 2U);
  EXPECT_TRUE(tracks[0].alive);
}

TEST(FeatureTracks, ACloneLeavesWithItsObservations) {
  FeatureTracks tracks;
  for (std::uint64_t clone = 0; clone < 3; ++clone) tracks.Add(Frames({{3, 8}, {8}}), clone);
  EXPECT_TRUE(tracks.Sees(1));
  tracks.RemoveClone(1);
  EXPECT_FALSE(tracks.Sees(1));
  EXPECT_EQ(tracks[0].observations.size(), 2U);
  EXPECT_EQ(tracks[1].observations.size(), 4U);
}

TEST(FeatureTracks, MemoryOfEndedTracksHoldsNothingOver) {
  FeatureTracks tracks;
  tracks.Add(Frames({{1}}), 0);
  tracks.Consume(0);
  tracks.Add(Frames({{}}), 1);
  tracks.RemoveEnded();
  tracks.Add(Frames({{2}}), 2);
  EXPECT_EQ(tracks[0].observations.size(), 1U);
  EXPECT_TRUE(tracks[0].alive);
}

}  // namespace
}  // namespace duet
