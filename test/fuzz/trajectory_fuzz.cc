#include "common/dataset/ground_truth.h"
#include "common/support/logging.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    const duet::GroundTruth truth = duet::ReadTrajectory(text, "f");
    const duet::GroundTruth tum = duet::ReadTrajectory(duet::WriteTumTrajectory(truth.poses), "g");
    const duet::GroundTruth asl = duet::ReadTrajectory(duet::WriteGroundTruthTable(truth), "h");
    CHECK_EQ(tum.poses.size(), truth.poses.size());
    CHECK(tum.poses.back().timestamp == truth.poses.back().timestamp);
    CHECK(asl.poses.back().T_GB.p == truth.poses.back().T_GB.p);
    CHECK_EQ(asl.velocities.size(), truth.velocities.size());
  });
}
