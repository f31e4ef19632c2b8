// Jumps and splines of the real truth of EuRoC; needs the recordings.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "common/dataset/asl_tables.h"
#include "common/dataset/ground_truth.h"
#include "common/geometry/pose_jumps.h"
#include "common/geometry/pose_spline.h"
#include "common/imu/imu_buffer.h"
#include "common/imu/imu_delta.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

struct Recording {
  std::vector<StampedPose> poses;
  std::vector<std::optional<RelativeMotion>> motion;
  ImuBuffer imu;
};

// $DUET_DATA or, beside the repository, ../shared/data.
fs::path DataFolder() {
  const char* told = std::getenv("DUET_DATA");
  if (told != nullptr) return told;
  return fs::path(__FILE__).parent_path().parent_path().parent_path().parent_path().parent_path() /
         "shared/data";
}

// Every `stride`-th pose of the truth.
Recording Load(const fs::path& folder, std::size_t stride) {
  Recording recording;
  const GroundTruth truth =
      ReadTrajectoryFile(folder / "mav0/state_groundtruth_estimate0/data.csv");
  for (std::size_t i = 0; i < truth.poses.size(); i += stride) {
    recording.poses.push_back(truth.poses[i]);
  }
  const fs::path table = folder / "mav0/imu0/data.csv";
  for (const ImuSample& sample : ReadImuTable(ReadTextFile(table), table)) {
    recording.imu.Add(sample);
  }
  std::vector<ImuSample> readings;
  for (std::size_t i = 0; i + 1 < recording.poses.size(); ++i) {
    const Timestamp start = recording.poses[i].timestamp;
    const Timestamp end = recording.poses[i + 1].timestamp;
    recording.motion.emplace_back();
    if (!recording.imu.Covers(start, end)) continue;
    recording.imu.Extract(start, end, &readings);
    const ImuDelta delta = IntegrateImu(readings, {}, {}, {}, {false, false, false});
    recording.motion.back() = RelativeMotion{delta.R, delta.s, delta.y};
  }
  return recording;
}

const Eigen::Vector3d kGravity_G(0.0, 0.0, -9.81);

class RecordedTruthTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(DataFolder() / "euroc")) {
      GTEST_SKIP() << "no recordings: neither DUET_DATA nor ../shared/data beside the repository";
    }
  }
};

TEST_F(RecordedTruthTest, JumpsOfMh01AreFound) {
  const Timestamp first_image = 1403636584763555584;
  for (const std::size_t stride : {1, 10}) {
    const Recording recording = Load(DataFolder() / "euroc/MH_01_easy_05s", stride);
    const auto jumps = FindPoseJumps(recording.poses, recording.motion, kGravity_G);
    // Seconds from the first image and sizes that are known, and a fourth of 1.9 mm.
    const double instants_s[4] = {-0.035, 0.765, 11.120, 11.770};
    const double sizes_m[4] = {0.009, 0.005, 0.0019, 0.003};
    ASSERT_EQ(jumps.size(), 4) << stride;
    for (int i = 0; i < 4; ++i) {
      const auto stamp = first_image + ToNanoseconds(instants_s[i]);
      EXPECT_LE(jumps[i].before - 3000000, stamp);
      EXPECT_GE(jumps[i].after + 3000000, stamp);
      EXPECT_NEAR(jumps[i].displacement.norm(), sizes_m[i], 0.0005);
    }
    if (stride == 1) {
      EXPECT_EQ(FindPoseJumps(recording.poses).size(), 4) << "without the IMU";
    }
  }
}

TEST_F(RecordedTruthTest, LargestJumpsOfMh03AndMh04AreFound) {
  const auto largest = [](const std::vector<PoseJump>& jumps) {
    double size = 0.0;
    for (const PoseJump& jump : jumps) size = std::max(size, jump.displacement.norm());
    return size;
  };
  // The README tells the distance between two stamps, 85 mm and 139 mm: jump and motion (1 to 2 m/s
  // for 5 ms) together.
  const Recording mh03 = Load(DataFolder() / "inertial/MH_03_medium", 1);
  EXPECT_NEAR(largest(FindPoseJumps(mh03.poses, mh03.motion, kGravity_G)), 0.081, 0.001);
  const Recording mh04 = Load(DataFolder() / "inertial/MH_04_difficult", 1);
  EXPECT_NEAR(largest(FindPoseJumps(mh04.poses, mh04.motion, kGravity_G)), 0.130, 0.001);
}

TEST_F(RecordedTruthTest, NoJumpsWhereThereAreNone) {
  for (const char* name : {"euroc/V1_01_easy_00s", "inertial/V1_03_difficult"}) {
    const Recording recording = Load(DataFolder() / name, 1);
    EXPECT_TRUE(FindPoseJumps(recording.poses, recording.motion, kGravity_G).empty()) << name;
  }
}

// Simulations fly along such splines: their rates must be those of the real flight.
TEST_F(RecordedTruthTest, SplineThroughTruthAgreesWithTheImu) {
  Recording recording = Load(DataFolder() / "inertial/MH_04_difficult", 1);
  RemovePoseJumps(FindPoseJumps(recording.poses, recording.motion, kGravity_G), &recording.poses);
  const PoseSpline spline = PoseSpline::Fit(recording.poses, 0.05);
  double residual2 = 0.0;
  for (const StampedPose& pose : recording.poses) {
    residual2 += spline.Residual(pose).tail<3>().squaredNorm();
  }
  EXPECT_LT(std::sqrt(residual2 / static_cast<double>(recording.poses.size())), 5e-4);

  // Change of velocity and rotation over 0.25 s, spline against IMU, less the constant that its
  // biases make.
  std::array<std::vector<double>, 6> departures;
  std::vector<ImuSample> readings;
  const Timestamp step = 250000000;
  for (Timestamp t = spline.start() + step; t + step < spline.end() - step; t += step) {
    if (!recording.imu.Covers(t, t + step)) continue;
    recording.imu.Extract(t, t + step, &readings);
    const ImuDelta delta = IntegrateImu(readings, {}, {}, {}, {false, false, false});
    const Kinematics a = spline.At(t), b = spline.At(t + step);
    const Eigen::Vector3d theta = BoxMinus(a.T_GB.R.conjugate() * b.T_GB.R, delta.R);
    const Eigen::Vector3d s =
        a.T_GB.R.conjugate() * (b.v_GB - a.v_GB - kGravity_G * delta.dt_s) - delta.s;
    for (int i = 0; i < 3; ++i) {
      departures[i].push_back(theta[i]);
      departures[i + 3].push_back(s[i]);
    }
  }
  for (int i = 0; i < 6; ++i) {
    std::vector<double>& d = departures[i];
    ASSERT_GT(d.size(), 300);
    const auto median = [](std::vector<double> values) {
      std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
      return values[values.size() / 2];
    };
    const double constant = median(d);
    for (double& value : d) value = std::abs(value - constant);
    // Measured: 3e-4 rad and 7e-3 m/s, of which the truth's own noise (1e-4 rad, some mm/s) and
    // remaining jumps below 1 mm are most.
    EXPECT_LT(median(d), i < 3 ? 6e-4 : 0.015) << i;
  }
}

}  // namespace
}  // namespace duet
