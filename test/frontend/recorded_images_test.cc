// The front end on real images of EuRoC; needs the recordings.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "common/dataset/recording.h"
#include "frontend/frontend.h"
#include "frontend/gyro_rotation.h"
#include "frontend/image_source.h"
#include "frontend/outlier_rejection.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

// $DUET_DATA or, beside the repository, ../shared/data.
fs::path DataFolder() {
  if (const char* told = std::getenv("DUET_DATA")) return told;
  return fs::path(__FILE__).parent_path().parent_path().parent_path().parent_path() / "shared/data";
}

class RecordedImagesTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = DataFolder() / "euroc/MH_01_easy_05s";
    if (!fs::exists(folder_)) {
      GTEST_SKIP() << "no recording at " << folder_
                   << " (set DUET_DATA to the folder that holds it)";
    }
  }

  void Track(std::vector<int> cameras) {
    RecordingOptions options;
    options.cameras = std::move(cameras);
    options.source = RecordingOptions::Source::kImages;
    options.duration_s = 2.5;
    recording_ = LoadRecording(folder_, options);
    std::vector<ImageFiles> files;
    for (const ImageStamp& stamp : recording_.images) {
      files.push_back({stamp.timestamp, stamp.paths});
    }
    ImageSource source(std::move(files), recording_.rig);
    Frontend frontend(FrontendOptions{}, 150, recording_.rig);
    std::size_t next = 0;
    while (const std::optional<ImageSet> set = source.Next()) {
      while (next < recording_.imu.size() && recording_.imu[next].timestamp <= set->timestamp) {
        frontend.AddImu(recording_.imu[next++]);
      }
      stream_.push_back(frontend.Process(set->timestamp, set->images));
    }
    statistics_ = frontend.statistics();
  }

  // R_B1B0 by the gyroscope with the bias that the front end found.
  Eigen::Quaterniond Rotation(Timestamp t0, Timestamp t1) const {
    GyroRotation gyro{ImuCalibration{}};
    for (ImuSample sample : recording_.imu) {
      sample.omega_m -= statistics_.b_g;
      gyro.Add(sample);
    }
    return *gyro.Between(t0, t1);
  }

  fs::path folder_;
  Recording recording_;
  std::vector<TrackFrameSet> stream_;
  FrontendStatistics statistics_;
};

// Half a second apart, with the best motion between the two frames taken out.
TEST_F(RecordedImagesTest, TracksFitOneMotionOverHalfASecond) {
  Track({0});
  ASSERT_GE(stream_.size(), 49U);
  const CameraModel& model = recording_.rig.cameras[0].model;
  constexpr std::size_t kLag = 10;
  Random random(0);
  int outliers = 0;
  int all = 0;
  for (std::size_t i = kLag; i < stream_.size(); ++i) {
    std::map<std::uint64_t, Eigen::Vector3d> before;
    for (const TrackObservation& o : stream_[i - kLag].frames[0].observations) {
      before[o.track_id] = *model.Unproject({o.u, o.v});
    }
    std::vector<RayPair> pairs;
    for (const TrackObservation& o : stream_[i].frames[0].observations) {
      if (before.contains(o.track_id)) {
        pairs.push_back({before[o.track_id], *model.Unproject({o.u, o.v})});
      }
    }
    EXPECT_GE(pairs.size(), 30U);
    const Eigen::Quaterniond R_CB = recording_.rig.cameras[0].R_CB;
    const Eigen::Quaterniond R_C1C0 =
        R_CB * Rotation(stream_[i - kLag].timestamp, stream_[i].timestamp) * R_CB.conjugate();
    std::vector<bool> inlier;
    const EpipolarMotion motion = FindEpipolarMotion(
        pairs, R_C1C0.toRotationMatrix(),
        {.iterations = 100, .focal_px = 458.0, .threshold_px = 1.0}, &random, &inlier);
    EXPECT_TRUE(motion.valid);
    outliers += static_cast<int>(std::count(inlier.begin(), inlier.end(), false));
    all += static_cast<int>(inlier.size());
  }
  // Sampson's distance of 1 px; flow from frame to frame alone leaves a quarter beyond it.
  EXPECT_LT(outliers, 0.03 * all);
  // The clip's own bias, from its ground truth file's fit: about (-0.002, 0.021, 0.079) rad/s.
  EXPECT_LT((statistics_.b_g - Eigen::Vector3d(-0.002, 0.021, 0.079)).norm(), 0.006);
  EXPECT_GE(statistics_.total.kept, 120 * static_cast<int>(stream_.size() - 1));
}

TEST_F(RecordedImagesTest, HalfOfTheTracksHaveAPartnerInTheSecondCamera) {
  Track({0, 1});
  EXPECT_GE(statistics_.total.stereo_matched, statistics_.total.stereo_unmatched);
}

}  // namespace
}  // namespace duet
