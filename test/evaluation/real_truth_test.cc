#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "common/dataset/ground_truth.h"
#include "evaluation/evaluate.h"
#include "test/evaluation/test_trajectories.h"

namespace duet {
namespace {

std::filesystem::path DataFolder() {
  if (const char* folder = std::getenv("DUET_DATA")) return folder;
  return std::filesystem::path(DUET_SOURCE_DIR).parent_path() / "shared" / "data";
}

/// A recorded truth at 20 Hz, moved and with noise, as an estimate: the noise comes out.
class RealTruthTest : public testing::TestWithParam<const char*> {};

TEST_P(RealTruthTest, NoiseThatWasPutInComesOut) {
  const auto file = DataFolder() / GetParam() / "mav0" / "state_groundtruth_estimate0" / "data.csv";
  if (!std::filesystem::exists(file)) {
    GTEST_SKIP() << "no recording at " << file << " (set DUET_DATA to the folder of recordings)";
  }
  const NamedTrajectory truth{"truth", ReadTrajectoryFile(file).poses};
  ASSERT_GT(truth.poses.size(), 1000u);
  // 20 Hz, 2 ms off the truth's stamps: it has to be interpolated.
  std::vector<StampedPose> shifted;
  for (std::size_t i = 1; i + 1 < truth.poses.size(); i += 10) {
    const StampedPose& a = truth.poses[i];
    const StampedPose& b = truth.poses[i + 1];
    const double share = 2e-3 / SecondsBetween(a.timestamp, b.timestamp);
    shifted.push_back({a.timestamp + 2 * kMs,
                       {a.T_GB.R.slerp(share, b.T_GB.R),
                        Eigen::Vector3d((1.0 - share) * a.T_GB.p + share * b.T_GB.p)}});
  }
  Random random(37);
  const double sigma_m = 0.02;
  const double sigma_deg = 0.5;
  const auto estimate =
      Moved(WithNoise(shifted, sigma_m, sigma_deg * std::numbers::pi / 180.0, &random),
            YawRotation(-2.0), {10, 20, 30});
  const Evaluation evaluation = Evaluate(truth, {{"estimate", estimate}}, {});
  const TrajectoryEvaluation& result = evaluation.estimates[0];
  EXPECT_GT(result.association.MatchedShare(), 0.99);
  EXPECT_GT(result.coverage_share, 0.98);
  // The rmse of 3 n numbers scatters by 1 / sqrt(6 n); four of that, and 1 % for what the fit
  // takes.
  const double scatter = 4.0 / std::sqrt(6.0 * result.absolute.position_m.count) + 0.01;
  EXPECT_NEAR(result.absolute.position_m.rmse / (std::sqrt(3.0) * sigma_m), 1.0, scatter);
  EXPECT_NEAR(result.absolute.orientation_deg.rmse / (std::sqrt(3.0) * sigma_deg), 1.0, scatter);
  EXPECT_NEAR(result.absolute.tilt_deg.rmse / (std::sqrt(2.0) * sigma_deg), 1.0, 1.3 * scatter);
  // A segment's ends have independent noise: twice its variance (and the start's rotation error
  // times the way moved).
  ASSERT_FALSE(result.relative.empty());
  const RelativeErrors& shortest = result.relative.front();
  EXPECT_NEAR(shortest.rotation_deg.rmse / (std::sqrt(6.0) * sigma_deg), 1.0, 2.0 * scatter);
}

INSTANTIATE_TEST_SUITE_P(Recordings, RealTruthTest,
                         testing::Values("euroc/MH_01_easy_05s", "inertial/MH_03_medium",
                                         "inertial/V1_03_difficult", "inertial/V2_01_easy"));

}  // namespace
}  // namespace duet
