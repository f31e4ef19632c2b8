#include "experiments/report/run_curves.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "common/geometry/so3.h"
#include "common/support/numeric_text.h"
#include "common/support/random.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

constexpr Timestamp kStart = 1'400'000'000'000'000'000;
constexpr Timestamp kStep = 50'000'000;

std::size_t ColumnOf(const std::string& name) {
  const auto* found = std::find(kCurveColumns.begin(), kCurveColumns.end(), name);
  return static_cast<std::size_t>(found - kCurveColumns.begin()) - 1;  // t is no column
}

// Noise in every column, so that extremes lie anywhere.
RunCurves Noisy(std::size_t count) {
  Random random(7);
  RunCurves curves;
  curves.all_instants = count;
  for (std::size_t i = 0; i < count; ++i) {
    curves.instants.push_back(kStart + static_cast<Timestamp>(i) * kStep);
    for (std::vector<double>& column : curves.columns) column.push_back(random.Normal());
  }
  return curves;
}

TEST(RunCurvesTest, ThinningLosesNoExtremeOfWhatIsPlotted) {
  const RunCurves curves = Noisy(5000);
  for (const std::size_t most : {100U, 700U, 2000U}) {
    const RunCurves thinned = Thinned(curves, most);
    EXPECT_LE(thinned.instants.size(), most);
    EXPECT_GT(thinned.instants.size(), most / 2);  // the room is used
    EXPECT_EQ(thinned.all_instants, 5000);
    EXPECT_EQ(thinned.instants.front(), curves.instants.front());
    EXPECT_EQ(thinned.instants.back(), curves.instants.back());
    EXPECT_TRUE(std::is_sorted(thinned.instants.begin(), thinned.instants.end()));
    for (const char* name : {"p_x", "e_p_x", "e_p_y", "e_p_z", "e_theta_x", "e_theta_z", "P_xx",
                             "s_theta_y", "nees_pose"}) {
      const std::vector<double>& all = curves.columns[ColumnOf(name)];
      const std::vector<double>& kept = thinned.columns[ColumnOf(name)];
      EXPECT_EQ(*std::max_element(kept.begin(), kept.end()),
                *std::max_element(all.begin(), all.end()))
          << name << " of " << most;
      EXPECT_EQ(*std::min_element(kept.begin(), kept.end()),
                *std::min_element(all.begin(), all.end()))
          << name << " of " << most;
    }
  }
}

TEST(RunCurvesTest, ThinnedRowsAreRowsOfTheRun) {
  const RunCurves curves = Noisy(900);
  const RunCurves thinned = Thinned(curves, 200);
  for (std::size_t i = 0; i < thinned.instants.size(); ++i) {
    const auto row = static_cast<std::size_t>((thinned.instants[i] - kStart) / kStep);
    for (std::size_t c = 0; c < curves.columns.size(); ++c) {
      EXPECT_EQ(thinned.columns[c][i], curves.columns[c][row]);
    }
  }
}

TEST(RunCurvesTest, AColumnThatTheRecordDoesNotHaveKeepsNothing) {
  RunCurves curves = Noisy(3000);
  for (std::vector<double>& column : curves.columns) {
    std::fill(column.begin(), column.end(), std::numeric_limits<double>::quiet_NaN());
  }
  std::vector<double>& x = curves.columns[ColumnOf("p_x")];
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = static_cast<double>(i);
  EXPECT_LE(Thinned(curves, 300).instants.size(), 300);
  EXPECT_EQ(Thinned(curves, 3000).instants.size(), 3000);  // nothing to thin
}

std::string Decode64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
    count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 0xFF);
  }
  return bytes;
}

TEST(RunCurvesTest, EncodedCurvesReadBackToTheSameFloats) {
  RunCurves curves = Noisy(37);
  curves.columns[3][5] = std::numeric_limits<double>::quiet_NaN();
  const std::string text = EncodeCurves(curves, kStart - kStep);
  EXPECT_EQ(text.size(), EncodedSize(37));
  const std::string bytes = Decode64(text);
  ASSERT_EQ(bytes.size(), 37 * kCurveColumns.size() * 4);
  const auto value = [&bytes](std::size_t column, std::size_t row) {
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 4; ++b) {
      const auto byte = static_cast<unsigned char>(bytes[4 * (column * 37 + row) + b]);
      bits |= static_cast<std::uint32_t>(byte) << 8 * b;
    }
    float number = 0.0F;
    std::memcpy(&number, &bits, sizeof number);
    return number;
  };
  for (std::size_t row = 0; row < 37; ++row) {
    EXPECT_EQ(value(0, row), static_cast<float>(0.05 * static_cast<double>(row + 1)));
    for (std::size_t c = 0; c < curves.columns.size(); ++c) {
      if (std::isnan(curves.columns[c][row])) {
        EXPECT_TRUE(std::isnan(value(c + 1, row)));
      } else {
        EXPECT_EQ(value(c + 1, row), static_cast<float>(curves.columns[c][row]));
      }
    }
  }
}

/// A record of two states with a covariance, and its truth.
class RecordedCurvesTest : public testing::Test {
 protected:
  RecordedCurvesTest() {
    folder_ = fs::path(testing::TempDir()) / ("run_curves_test-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    std::string states = "#timestamp [ns],frame [ns],status";
    for (int i = 0; i < 16; ++i) states += ",c";
    states += "\n";
    std::string covariances = "#timestamp [ns],size\n";
    for (int i = 0; i < 2; ++i) {
      const Timestamp t = kStart + i * kStep;
      const Eigen::Quaterniond R = ExpQuaternion(r_);
      states += std::to_string(t) + "," + std::to_string(t) + ",tracking";
      for (const double v : {R.x(), R.y(), R.z(), R.w(), 1.0 + i, 2.0, 3.0}) {
        states += "," + FormatNumber(v);
      }
      states += ",0,0,0,0,0,0,0,0,0\n";
      covariances += std::to_string(t) + ",15";
      for (int row = 0; row < 15; ++row) {
        for (int column = 0; column <= row; ++column) {
          covariances += row == column ? ",0.04" : row == 4 && column == 3 ? ",0.01" : ",0";
        }
      }
      covariances += "\n";
      truth_.poses.push_back({t,
                              {BoxPlus(R, theta_), Eigen::Vector3d(1.0 + i, 2.0, 3.0) +
                                                       Eigen::Vector3d(0.1, 0, -0.2)}});
    }
    WriteTextFile(folder_ / "states.csv", states);
    WriteTextFile(folder_ / "covariance.csv", covariances);
  }
  ~RecordedCurvesTest() override { fs::remove_all(folder_); }

  fs::path folder_;
  Eigen::Vector3d r_{0.3, -0.2, 0.9};
  Eigen::Vector3d theta_{0.02, -0.01, 0.03};
  GroundTruth truth_;
};

TEST_F(RecordedCurvesTest, ErrorsAreTrueMinusEstimateAndGlobal) {
  const std::optional<RunCurves> curves = ReadRunCurves(folder_, &truth_, true);
  ASSERT_TRUE(curves);
  const auto at = [&](const char* name) { return curves->columns[ColumnOf(name)][1]; };
  EXPECT_DOUBLE_EQ(at("p_x"), 2.0);
  EXPECT_NEAR(at("e_p_x"), 0.1, 1e-12);  // rounding of the difference
  EXPECT_NEAR(at("e_p_z"), -0.2, 1e-12);
  EXPECT_NEAR(at("r_z"), 0.9, 1e-12);
  EXPECT_NEAR(at("e_theta_x"), 0.02, 1e-12);
  EXPECT_NEAR(at("e_theta_y"), -0.01, 1e-12);
  EXPECT_DOUBLE_EQ(at("P_xx"), 0.04);
  EXPECT_DOUBLE_EQ(at("P_xy"), 0.01);
  EXPECT_DOUBLE_EQ(at("s_theta_x"), 0.2);
  // 0.1^2 / (0.04 - 0.01^2 / 0.04) + 0.2^2 / 0.04
  EXPECT_NEAR(at("nees_position"), 0.01 / 0.0375 + 1.0, 1e-9);
  EXPECT_NEAR(at("nees_orientation"), theta_.squaredNorm() / 0.04, 1e-9);
}

TEST_F(RecordedCurvesTest, WithoutATruthThereAreNoErrorsAndNoNees) {
  const std::optional<RunCurves> curves = ReadRunCurves(folder_, nullptr, true);
  ASSERT_TRUE(curves);
  for (const char* name : {"e_p_x", "e_theta_z", "nees_pose"}) {
    EXPECT_TRUE(std::isnan(curves->columns[ColumnOf(name)][0])) << name;
  }
  EXPECT_DOUBLE_EQ(curves->columns[ColumnOf("P_zz")][0], 0.04);
  EXPECT_FALSE(curves->alignment);
  const std::optional<RunCurves> real = ReadRunCurves(folder_, &truth_, false);
  EXPECT_TRUE(std::isnan(real->columns[ColumnOf("nees_pose")][0])) << "claimed of real tracks";
}

}  // namespace
}  // namespace duet
