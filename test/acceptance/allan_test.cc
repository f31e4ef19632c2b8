#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "test/acceptance/program.h"

namespace duet {
namespace {

// A folder with what docs/formats.md says, with the figure and without gnuplot.
TEST(Allan, WritesNumbersAndScriptAndWhereItCanTheFigure) {
  TemporaryFolder folder;
  const ProgramResult simulated =
      RunDuet({"simulate", "--set", "trajectory=standstill", "--set", "duration_s=60", "--set",
               "max_tracks=1", "--out", folder / "rest"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const ProgramResult result =
      RunDuet({"allan", "--dataset", folder / "rest", "--out", folder / "allan"});
  ASSERT_EQ(result.status, 0) << result.err;
  const auto json = nlohmann::json::parse(ReadFile(folder / "allan/allan.json"));
  EXPECT_EQ(json.at("samples").get<int>(), 12081);
  EXPECT_EQ(json.at("moves").get<bool>(), false);
  // A minute of 200 Hz: white densities to a percent or two.
  EXPECT_NEAR(json.at("mean_of_axes").at("gyroscope_noise_density").get<double>() / 1.6968e-4, 1.0,
              0.1);
  const std::vector<std::string> files = FilesIn(folder / "allan");
  if (result.err.find("gnuplot is not installed") == std::string::npos) {
    EXPECT_EQ(files, (std::vector<std::string>{"allan.csv", "allan.gp", "allan.json", "allan.pdf",
                                               "allan.png", "allan.svg"}));
  }

  const std::string path = std::getenv("PATH") == nullptr ? "" : std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const ProgramResult bare = RunDuet(
      {"allan", "--dataset", folder / "rest", "--duration", "30", "--out", folder / "bare"});
  setenv("PATH", path.c_str(), 1);
  ASSERT_EQ(bare.status, 0) << bare.err;
  EXPECT_NE(bare.err.find("gnuplot is not installed"), std::string::npos) << bare.err;
  EXPECT_EQ(FilesIn(folder / "bare"),
            (std::vector<std::string>{"allan.csv", "allan.gp", "allan.json"}));
  EXPECT_EQ(nlohmann::json::parse(ReadFile(folder / "bare/allan.json")).at("samples").get<int>(),
            6001);

  const ProgramResult again =
      RunDuet({"allan", "--dataset", folder / "rest", "--out", folder / "allan"});
  EXPECT_EQ(again.status, 2);
}

}  // namespace
}  // namespace duet
