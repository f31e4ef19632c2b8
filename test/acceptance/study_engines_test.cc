// The long tests of duet study: 20 kills, and the engines that are shipped for it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "common/support/random.h"
#include "test/acceptance/program.h"
#include "test/acceptance/tiny_study.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

class StudyEnginesTest : public testing::Test {
 protected:
  void SetUp() override {
    WriteFile(study_, kTinyStudy);
    const auto start = std::chrono::steady_clock::now();
    const ProgramResult result =
        RunDuet({"study", study_, "--out", folder_ / "local", "--jobs", "2", "--quiet"});
    ASSERT_EQ(result.status, 0) << result.err;
    elapsed_s_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    undisturbed_ = CanonicalFilesOf(folder_ / "local");
  }

  TemporaryFolder folder_;
  std::string study_ = folder_ / "tiny.yaml";
  std::string out_ = folder_ / "out";
  double elapsed_s_ = 0.0;
  std::map<std::string, std::string> undisturbed_;
};

TEST_F(StudyEnginesTest, KilledAtTwentyRandomMomentsItEndsWithTheSameBytes) {
  Random random(20);
  int kills = 0;
  for (int i = 0; i < 20; ++i) {
    // A study that has got through is begun anew.
    if (fs::exists(out_ + "/manifest.json")) {
      EXPECT_EQ(CanonicalFilesOf(out_), undisturbed_);
      fs::remove_all(out_);
    }
    const auto after = std::chrono::duration<double>(random.Uniform(0.0, elapsed_s_));
    const auto start = std::chrono::steady_clock::now();
    const ProgramResult result = RunDuet(
        {"study", study_, "--out", out_, "--jobs", i % 2 == 0 ? "2" : "1", "--quiet"},
        [&] { return std::chrono::steady_clock::now() - start > after; }, SIGKILL);
    kills += result.status == 128 + SIGKILL ? 1 : 0;
  }
  EXPECT_GE(kills, 10);
  const ProgramResult last = RunDuet({"study", study_, "--out", out_, "--jobs", "2", "--quiet"});
  ASSERT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(CanonicalFilesOf(out_), undisturbed_);
}

TEST_F(StudyEnginesTest, TwoHostsAtOnceTearAndDuplicateNothing) {
  // Processes that know nothing of one another do the same runs at the same time.
  const ProgramResult plan = RunDuet({"study", study_, "--out", out_, "--plan"});
  ASSERT_EQ(plan.status, 0) << plan.err;
  WriteFile(folder_ / "plan", plan.out);
  const ProgramResult both = RunShell("sh '" + (folder_ / "plan") + "' & a=$!; sh '" +
                                      (folder_ / "plan") + "' & b=$!; wait $a && wait $b");
  ASSERT_EQ(both.status, 0) << both.err;
  ASSERT_EQ(RunDuet({"study", study_, "--out", out_, "--quiet"}).status, 0);
  EXPECT_EQ(CanonicalFilesOf(out_), undisturbed_);
}

TEST_F(StudyEnginesTest, ByGnuParallelItIsTheSame) {
  SKIP_WITHOUT_PROGRAM("parallel", "parallel");
  const ProgramResult result =
      RunShell("'" DUET_SOURCE "/experiments/engines/gnu_parallel.sh' 2 '" + study_ + "' --out '" +
               out_ + "' --quiet");
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(CanonicalFilesOf(out_), undisturbed_);
}

/// Slurm's daemons on this machine alone, as long as the object lives.
class SlurmOnOneMachine {
 public:
  explicit SlurmOnOneMachine(const std::string& folder) : folder_(folder) {
    fs::create_directories(folder_);
    const ProgramResult started =
        RunShell("sh '" DUET_SOURCE "/test/acceptance/slurm.sh' start '" + folder_ + "'");
    started_ = started.status == 0;
    why_ = started.out + started.err;
  }
  ~SlurmOnOneMachine() {
    (void)RunShell("sh '" DUET_SOURCE "/test/acceptance/slurm.sh' stop '" + folder_ + "'");
  }
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] const std::string& why() const { return why_; }

 private:
  std::string folder_;
  bool started_ = false;
  std::string why_;
};

TEST_F(StudyEnginesTest, ByASlurmArrayItIsTheSame) {
  SKIP_WITHOUT_PROGRAM("slurmctld", "slurm-wlm");
  const SlurmOnOneMachine slurm(folder_ / "slurm");
  if (!slurm.started()) {
    GTEST_SKIP() << "SKIPPED: Slurm's daemons cannot be started here: " << slurm.why();
  }
  const std::string conf = "export SLURM_CONF='" + (folder_ / "slurm") + "/slurm.conf'\n";
  const ProgramResult submitted =
      RunShell(conf + "'" DUET_SOURCE "/experiments/engines/slurm_array.sh' '" + study_ +
               "' --out '" + out_ + "' --quiet");
  ASSERT_EQ(submitted.status, 0) << submitted.err;
  for (int i = 0; i < 600 && !fs::exists(out_ + "/manifest.json"); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  ASSERT_TRUE(fs::exists(out_ + "/manifest.json"))
      << RunShell(conf + "squeue; sinfo; cat '" + out_ + "'/slurm/*").out;
  EXPECT_EQ(CanonicalFilesOf(out_), undisturbed_);
}

}  // namespace
}  // namespace duet
