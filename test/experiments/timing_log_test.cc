#include "experiments/timing_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/support/input_error.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

using testing::ElementsAre;
using testing::Pair;

TEST(TimingLogTest, ColumnsReadBackWithoutTheFramesThatLackThem) {
  TimingLog log;
  log.StartFrame(10);
  log.Add("decode", 1.5);
  log.StartFrame(20);
  log.Add("decode", 0.25);
  log.Add("estimator", 2.0);
  log.Add("estimator", 1.0);
  log.Add("estimator", std::vector<StageTimer::Stage>{{"update", 0.5}});
  const std::filesystem::path path =
      std::filesystem::path(testing::TempDir()) / "timing_log_test.csv";
  log.Write(path);
  EXPECT_EQ(ReadTextFile(path),
            "#timestamp [ns],decode [ms],estimator [ms],estimator.update [ms]\n"
            "10,1.5000,,\n"
            "20,0.2500,3.0000,0.5000\n");
  EXPECT_THAT(
      ReadTimingTable(ReadTextFile(path), "timing.csv"),
      ElementsAre(Pair("decode", ElementsAre(1.5, 0.25)), Pair("estimator", ElementsAre(3.0)),
                  Pair("estimator.update", ElementsAre(0.5))));
  std::filesystem::remove(path);
}

TEST(TimingLogTest, RefusesWhatIsNoTimingTable) {
  for (const char* text :
       {"#timestamp [ns],decode [ms]\n10,x\n", "#timestamp [ns],decode [ms]\n10,1,2\n",
        "#timestamp [ns],decode [ms]\n10,nan\n", "#timestamp [ns],decode [ms]\n10,1.5",
        "#timestamp [ns],decode\n10,1.5\n", "10,1.5\n"}) {
    EXPECT_THROW((void)ReadTimingTable(text, "timing.csv"), InputError) << text;
  }
}

}  // namespace
}  // namespace duet
