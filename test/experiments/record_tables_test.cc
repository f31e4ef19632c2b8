#include "experiments/record_tables.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/support/input_error.h"

namespace duet {
namespace {

std::string Features(const std::string& keyframes) {
  std::string csv = "#timestamp [ns],status,used,keyframe\n";
  for (std::size_t i = 0; i < keyframes.size(); ++i) {
    csv += std::to_string(1'000'000'000 + 100'000'000 * i) + ",tracking,5," + keyframes[i] + "\n";
  }
  return csv;
}

// Frames 0.1 s apart, a window of three.
TEST(RecordTables, WindowSpanFollowsWhichFramesStay) {
  // Each stays: 0.2 s from the third on.
  EXPECT_NEAR(ReadWindowSpan(Features("111111"), "f", 3), 0.2, 1e-12);
  // Frames 0 and 1 stay, then the one before each new one goes: windows {0, 1, 2}, {0, 2, 3} ... at
  // frames 2, 3, 4: 0.2, 0.3, 0.4 s, since a frame leaves at each.
  EXPECT_NEAR(ReadWindowSpan(Features("11000"), "f", 3), 0.3, 1e-12);
  EXPECT_TRUE(std::isnan(ReadWindowSpan(Features("11"), "f", 3)));
  EXPECT_TRUE(std::isnan(ReadWindowSpan(Features(""), "f", 3)));
  EXPECT_THROW((void)ReadWindowSpan("#timestamp [ns],status\n1,tracking\n", "f", 3), InputError);
}

}  // namespace
}  // namespace duet
