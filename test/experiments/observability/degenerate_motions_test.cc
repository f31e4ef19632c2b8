// What observability names on degenerate motions, against what is known of them: the table of
// docs/observability.md, row by row, and nothing else.

#include <gtest/gtest.h>

#include <algorithm>
#include <ostream>
#include <sstream>
#include <string>

#include "experiments/observability/observability_report.h"
#include "test/experiments/observability/small_simulation.h"

namespace duet {
namespace {

enum class Estimated { kEverything, kExtrinsicsAndTimeOffset, kImu, kCamera, kTimes };

CalibrationPriors Priors(Estimated estimated) {
  CalibrationPriors priors;
  switch (estimated) {
    case Estimated::kEverything:
      return AllEstimated();
    case Estimated::kExtrinsicsAndTimeOffset:
      priors.p_CB.estimated = priors.R_CB.estimated = priors.t_d.estimated = true;
      break;
    case Estimated::kImu:  // full matrices: the camera ties the axes
      priors.imu_frame = ImuFrame::kCamera;
      priors.T_g.estimated = priors.T_s.estimated = priors.T_a.estimated = true;
      break;
    case Estimated::kCamera:
      priors.intrinsics.estimated = priors.distortion.estimated = true;
      break;
    case Estimated::kTimes:
      priors.t_d.estimated = priors.t_r.estimated = true;
      break;
  }
  return priors;
}

// The room's walk without any turn.
std::shared_ptr<const Trajectory> PureTranslation(double duration_s) {
  HarmonicTrajectory::Channels channels{
      .x = {0.0, 0.0, {{2.0, 0.17, 0.0}, {0.35, 0.71, 0.4}, {0.12, 2.1, 1.0}}},
      .y = {0.0, 0.0, {{1.6, 0.23, 1.2}, {0.30, 0.63, 2.0}, {0.13, 1.9, 0.1}}},
      .z = {1.4, 0.0, {{0.35, 0.41, 0.3}, {0.07, 2.5, 0.8}}},
      .yaw = {0.4, 0.0, {}},
      .pitch = {0.3, 0.0, {}},
      .roll = {-0.2, 0.0, {}}};
  return std::make_shared<HarmonicTrajectory>(std::move(channels), TimeWarp(), duration_s);
}

struct Case {
  const char* motion;
  Estimated estimated;
  /// Words, "?" standing for 1, 2 and 3 or x, y and z as it comes; those that the layout does not
  /// have (the gauge's) are passed over.
  const char* unobservable;
};
std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.motion << " " << static_cast<int>(c.estimated);
}

constexpr const char* kImuAll = "T_g.?1 T_g.?2 T_g.?3 T_s.?1 T_s.?2 T_s.?3 T_a.?1 T_a.?2 T_a.?3 ";

// In the order of the layout, as AnalyzeObservability names them.
std::vector<std::string> Expanded(const std::string& words, const CalibrationLayout& layout) {
  std::vector<std::string> wanted;
  std::istringstream stream(words);
  for (std::string word; stream >> word;) {
    const std::size_t at = word.find('?');
    if (at == std::string::npos) {
      wanted.push_back(word);
      continue;
    }
    for (const char each : {'1', '2', '3', 'x', 'y', 'z'}) {
      wanted.push_back(word);
      wanted.back()[at] = each;
    }
  }
  std::vector<std::string> names;
  for (const std::string& name : layout.ComponentNames()) {
    if (std::find(wanted.begin(), wanted.end(), name) != wanted.end()) names.push_back(name);
  }
  return names;
}

class DegenerateMotion : public testing::TestWithParam<Case> {};

TEST_P(DegenerateMotion, NamesExactlyWhatIsKnownToBeUnobservable) {
  constexpr double kDuration_s = 12.0;
  const double span_s = kDuration_s + 2.0 * kImuMargin_s;
  const std::string motion = GetParam().motion;
  const ObservedSimulation simulation(
      ObservedSimulation::Options(kDuration_s),
      motion == "pure_translation" ? PureTranslation(span_s) : MakeTrajectory(motion, span_s, 0.0),
      Priors(GetParam().estimated));
  const FisherInformation information(simulation.motion);
  const WeakSpace space =
      UnobservableSpace(PredictWithWidePriors(information), information.layout());
  std::string directions;
  for (const CalibrationDirection& direction : space.Directions()) {
    directions += DirectionText(direction, information.layout().ComponentNames()) + "\n";
  }
  EXPECT_EQ(UnobservableComponents(space, information.layout()),
            Expanded(GetParam().unobservable, information.layout()))
      << directions;
}

const std::string kEverywhere = std::string(kImuAll) +
                                "cam0.p_CB.? cam0.R_CB.? cam0.fx cam0.fy cam0.ox cam0.oy cam0.k1 "
                                "cam0.k2 cam0.t1 cam0.t2 cam0.k3 t_d t_r";
const std::string kStraight =
    std::string(kImuAll) + "cam0.p_CB.? cam0.R_CB.? cam0.fx cam0.fy cam0.k1 cam0.k2 t_d";
const std::string kCircle = std::string(kImuAll) + "cam0.p_CB.? cam0.R_CB.? t_d";

INSTANTIATE_TEST_SUITE_P(
    Everything, DegenerateMotion,
    testing::Values(
        Case{"lissajous", Estimated::kEverything, ""},
        Case{"standstill", Estimated::kEverything, kEverywhere.c_str()},
        Case{"straight_line", Estimated::kEverything, kStraight.c_str()},
        Case{"circle", Estimated::kEverything, kCircle.c_str()},
        Case{"pure_rotation", Estimated::kEverything, "cam0.p_CB.?"},
        // The axis is the body's x, which is the camera's y.
        Case{"one_axis_rotation", Estimated::kEverything,
             "T_g.21 T_g.31 T_g.?2 T_g.?3 T_a.?1 T_a.?2 T_a.?3 cam0.p_CB.y cam0.R_CB.?"},
        Case{"constant_rate", Estimated::kEverything,
             "T_g.?1 T_g.?2 T_g.?3 T_a.?1 T_a.?2 T_a.?3 cam0.p_CB.? cam0.R_CB.?"},
        Case{"planar_driving", Estimated::kEverything,
             "T_g.21 T_g.31 T_g.?2 T_g.?3 T_s.?1 T_a.?1 T_a.?2 T_a.?3 cam0.p_CB.y cam0.R_CB.?"},
        // Along the body's z, the optical axis, and turning about it.
        Case{"constant_acceleration", Estimated::kEverything,
             "T_g.?1 T_g.?2 T_s.?3 T_a.?3 T_a.12 T_a.21 cam0.p_CB.? cam0.R_CB.z"}));

INSTANTIATE_TEST_SUITE_P(
    ExtrinsicsAndTimeOffset, DegenerateMotion,
    testing::Values(
        Case{"lissajous", Estimated::kExtrinsicsAndTimeOffset, ""},
        Case{"pure_translation", Estimated::kExtrinsicsAndTimeOffset, "cam0.p_CB.?"},
        Case{"one_axis_rotation", Estimated::kExtrinsicsAndTimeOffset, "cam0.p_CB.y"},
        Case{"planar_driving", Estimated::kExtrinsicsAndTimeOffset, "cam0.p_CB.y"},
        Case{"circle", Estimated::kExtrinsicsAndTimeOffset, "cam0.p_CB.? cam0.R_CB.? t_d"},
        Case{"straight_line", Estimated::kExtrinsicsAndTimeOffset, "cam0.p_CB.? cam0.R_CB.? t_d"}));

INSTANTIATE_TEST_SUITE_P(
    Imu, DegenerateMotion,
    testing::Values(
        Case{"lissajous", Estimated::kImu, ""}, Case{"pure_rotation", Estimated::kImu, ""},
        Case{"one_axis_rotation", Estimated::kImu, "T_g.?2 T_g.?3"},
        Case{"constant_rate", Estimated::kImu, "T_g.?1 T_g.?2 T_g.?3 T_a.11 T_a.22 T_a.33"},
        Case{"pure_translation", Estimated::kImu, "T_g.?1 T_g.?2 T_g.?3 T_a.11 T_a.22 T_a.33"},
        Case{"constant_acceleration", Estimated::kImu, "T_g.?1 T_g.?2 T_s.?3 T_a.?3 T_a.12 T_a.21"},
        Case{"straight_line", Estimated::kImu, kImuAll}));

INSTANTIATE_TEST_SUITE_P(Camera, DegenerateMotion,
                         testing::Values(Case{"pure_rotation", Estimated::kCamera, ""},
                                         Case{"pure_translation", Estimated::kCamera, ""},
                                         Case{"straight_line", Estimated::kCamera,
                                              "cam0.fx cam0.fy cam0.k1 cam0.k2"}));

INSTANTIATE_TEST_SUITE_P(Times, DegenerateMotion,
                         testing::Values(Case{"one_axis_rotation", Estimated::kTimes, ""},
                                         Case{"constant_rate", Estimated::kTimes, ""},
                                         Case{"circle", Estimated::kTimes, "t_d"},
                                         Case{"straight_line", Estimated::kTimes, "t_d"}));

// Combinations are found as such and named with their signs.
TEST(WeakSpace, FindsSingleComponentsAndCombinations) {
  const Eigen::Vector4d prior(2.0, 0.1, 5.0, 1.0);
  // In prior sigmas: the second as wide as before, the first minus half the third too.
  Eigen::Matrix4d M = 1e-6 * Eigen::Matrix4d::Identity();
  M(1, 1) = 1.0;
  Eigen::Vector4d v(1.0, 0.0, -0.5, 0.0);
  v.normalize();
  M += 0.81 * v * v.transpose();
  const Eigen::Matrix4d P = prior.asDiagonal() * M * prior.asDiagonal();
  const WeakSpace space(P, prior, 0.5);
  ASSERT_EQ(space.dimension(), 2);
  const std::vector<CalibrationDirection> directions = space.Directions();
  const std::vector<std::string> names = {"a", "b", "c", "d"};
  EXPECT_EQ(DirectionText(directions[0], names), "b");
  EXPECT_NEAR(directions[0].ratio, 1.0, 1e-5);
  EXPECT_EQ(DirectionText(directions[1], names), "a - 0.5 c");
  EXPECT_NEAR(directions[1].ratio, 0.9, 1e-5);
  const Eigen::Vector4d ratios(0.9 * std::sqrt(0.8), 1.0, 0.9 * std::sqrt(0.2), 0.0);
  EXPECT_LT((space.ComponentRatios() - ratios).cwiseAbs().maxCoeff(), 1e-5);
}

}  // namespace
}  // namespace duet
