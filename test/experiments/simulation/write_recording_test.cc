#include "experiments/simulation/write_recording.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/dataset/track_files.h"

namespace duet {
namespace {

TEST(WriteSimulatedRecording, ReadsBackAsItWas) {
  SimulationOptions options;
  options.duration_s = 2.0;
  options.cameras = 2;
  options.t_d_s = 0.004;
  options.t_r_s = 0.012;
  options.told_errors.p_CB_m = 0.02;
  options.told_errors.T_g = 0.01;
  const SimulatedRecording simulated = Simulate(options);
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "duet_write_simulated_recording";
  std::filesystem::remove_all(folder);
  WriteSimulatedRecording(simulated, folder);
  const Recording read = LoadRecording(folder, {.cameras = {0, 1}});
  std::filesystem::remove_all(folder);

  ASSERT_EQ(read.imu.size(), simulated.imu.size());
  for (std::size_t i = 0; i < read.imu.size(); ++i) {
    ASSERT_EQ(read.imu[i].timestamp, simulated.imu[i].timestamp);
    ASSERT_EQ(read.imu[i].omega_m, simulated.imu[i].omega_m);
    ASSERT_EQ(read.imu[i].a_m, simulated.imu[i].a_m);
  }
  EXPECT_EQ(HashTrackStream(read.tracks.frames), HashTrackStream(simulated.frames));
  EXPECT_EQ(read.tracks.renamed_ids, 0);
  EXPECT_EQ(read.imu_sensor.noise.gyroscope_density, simulated.noise.gyroscope_density);
  EXPECT_EQ(read.imu_sensor.gravity, 9.81);
  EXPECT_EQ(read.rig.imu.T_g, simulated.told_rig.imu.T_g);
  EXPECT_NE(read.rig.imu.T_g, simulated.true_rig.imu.T_g);
  EXPECT_EQ(read.rig.t_d_s, 0.004);
  EXPECT_EQ(read.rig.t_r_s, 0.012);
  for (std::size_t k = 0; k < 2; ++k) {
    // Files hold the inverse; the rest is rounding.
    EXPECT_LT((read.rig.cameras[k].p_CB - simulated.told_rig.cameras[k].p_CB).norm(), 1e-14);
    EXPECT_EQ(read.rig.cameras[k].model.parameters(),
              simulated.told_rig.cameras[k].model.parameters());
  }
  ASSERT_TRUE(read.truth.has_value());
  ASSERT_TRUE(read.truth->has_velocities());
  ASSERT_TRUE(read.truth->has_biases());
  EXPECT_EQ(read.truth->poses[7].T_GB.p, simulated.truth[7].nav.p_GB);
  EXPECT_EQ(read.truth->biases[7].b_a, simulated.truth[7].biases.b_a);
  EXPECT_TRUE(read.warnings.empty()) << read.warnings.front();
}

}  // namespace
}  // namespace duet
