#include "evaluation/metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "common/support/input_error.h"

namespace duet {
namespace {

TEST(Metrics, EveryKeyIsFoundOnceUnderItsName) {
  std::set<std::string> keys;
  for (const std::string& key : MetricKeys()) {
    EXPECT_TRUE(keys.insert(key).second) << key;
    const Metric metric = MetricOf(key);
    EXPECT_EQ(metric.key, key);
    EXPECT_FALSE(metric.words.empty());
    // A unit in the key is the unit in words.
    if (key.ends_with("_m")) {
      EXPECT_EQ(metric.unit, "m") << key;
    }
    if (key.ends_with("_deg")) {
      EXPECT_EQ(metric.unit, "deg") << key;
    }
  }
}

TEST(Metrics, KeysWithAParameter) {
  EXPECT_EQ(MetricOf("relative.position_m.5").unit, "m");
  EXPECT_EQ(MetricOf("relative.position_m.0.5").words, "position error over 0.5 m, median");
  EXPECT_EQ(MetricOf("relative.orientation_deg.10").unit, "deg");
  EXPECT_EQ(MetricOf("ate.position_m.se3").words, "position error (ATE), alignment se3");
  EXPECT_EQ(MetricOf("calibration.t_d.error").unit, "s");
  EXPECT_EQ(MetricOf("calibration.t_d.error").better, Better::kNearZero);
  EXPECT_EQ(MetricOf("calibration.cam0.p_CB.x.error").unit, "m");
  EXPECT_EQ(MetricOf("calibration.cam1.fx.sigma").better, Better::kNeither);
  EXPECT_EQ(MetricOf("calibration.T_s.yz.error").unit, "rad s/m");
  for (const char* wrong :
       {"", "ate", "relative.position_m.", "relative.position_m.-5", "relative.position_m.five",
        "relative.position_m.nan", "ate.position_m.umeyama", "calibration.t_d", "calibration.error",
        "calibration.nothing.error", "calibration.cam.fx.error", "calibration.camx.fx.error",
        "nees.pose.5"}) {
    EXPECT_FALSE(FindMetric(wrong).has_value()) << wrong;
    EXPECT_THROW((void)MetricOf(wrong), InputError) << wrong;
  }
}

TEST(Metrics, ScoreIsSmallerForTheBetter) {
  const auto better = [](const char* key, double good, double bad) {
    const Metric metric = MetricOf(key);
    EXPECT_LT(metric.Score(good), metric.Score(bad)) << key;
  };
  better("ate.position_m", 0.1, 0.2);
  better("coverage_share", 0.9, 0.8);
  better("calibration.t_d.error", -0.001, 0.002);
  better("nees.pose", 5.0, 12.0);
  better("nees.pose", 7.0, 3.0);
  // Half is as wrong as twice.
  EXPECT_DOUBLE_EQ(MetricOf("nees.pose").Score(3.0), MetricOf("nees.pose").Score(12.0));
}

}  // namespace
}  // namespace duet
