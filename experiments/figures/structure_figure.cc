#include <algorithm>
#include <cmath>
#include <vector>

#include "backends/msckf/filter_state.h"
#include "backends/msckf/linearization.h"
#include "common/geometry/so3.h"
#include "common/support/logging.h"
#include "experiments/figures/figure_makers.h"
#include "experiments/figures/figure_style.h"

namespace duet {
namespace {

constexpr int kClones = 6;

// A camera that looks along the body's x axis and everything of the rig estimated but the IMU's
// matrices, which a pixel does not depend on (DESIGN.md section 3).
RigCalibration StructureRig() {
  RigCalibration rig;
  CameraModel::Parameters parameters(9);
  parameters << 458.6, 457.3, 367.2, 248.4, -0.283, 0.0739, 1.9e-4, 1.8e-5, 0.002;
  rig.cameras.push_back({CameraModel(DistortionModel::kRadialTangential, 752, 480, parameters),
                         Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.06, -0.02, 0.01)});
  rig.t_r_s = 0.02;
  return rig;
}

CalibrationPriors StructurePriors() {
  CalibrationPriors priors;
  priors.T_g.estimated = priors.T_s.estimated = priors.T_a.estimated = true;
  priors.p_CB.estimated = true;
  priors.intrinsics.estimated = priors.distortion.estimated = true;
  priors.t_d.estimated = priors.t_r.estimated = true;
  return priors;
}

ImuBuffer TurningImu() {
  ImuBuffer buffer;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.005 * i;
    buffer.Add({ToNanoseconds(t), Eigen::Vector3d(0.3 * std::sin(3 * t), 0.2, 0.1),
                Eigen::Vector3d(std::cos(t), 0.5, 9.8)});
  }
  return buffer;
}

struct Group {
  std::string name;
  int first;
  int size;
};

}  // namespace

Figure Thesis63Figure(const FigureInput& /*input*/) {
  const RigCalibration rig = StructureRig();
  FilterState state(rig, StructurePriors(), kClones);
  InitialCondition initial;
  initial.state.instant = ToNanoseconds(0.5);
  state.Start(initial);
  const ImuBuffer imu = TurningImu();
  for (int i = 0; i < kClones; ++i) {
    const double t = 0.05 * i;
    NavState nav;
    nav.v_GB = Eigen::Vector3d(1.5, 0.3, 0.2);
    nav.p_GB = t * nav.v_GB;
    nav.R_GB = ExpQuaternion(Eigen::Vector3d(0.02, 0.1, -0.05) * t);
    state.SetPropagated(nav, initial.state.instant + ToNanoseconds(t));
    state.Augment(rig.t_d_s);
    Clone& clone = state.clones().back();
    clone.rates.Assign(imu, clone.instant, 0.03, initial.state.biases, rig.imu);
  }
  // The feature is seen in all clones but the first and the last.
  std::vector<CloneObservation> observations;
  for (int clone = 1; clone + 1 < kClones; ++clone) {
    observations.push_back({clone, {0, Eigen::Vector2d(300.0 + 5.0 * clone, 200.0)}});
  }
  VisualColumns columns;
  columns.Assign(state);
  const auto rows = static_cast<Eigen::Index>(2 * observations.size());
  LandmarkRows H_f(rows, 3);
  MeasurementRows H_r(rows, columns.width() + 1);
  const bool ok = LinearizeLandmark(state, columns, {}, 1, InverseDepth(0.1, -0.05, 0.3),
                                    observations, H_f, H_r);
  CHECK(ok) << "the example's landmark is in front of its cameras";
  Eigen::MatrixXd H_x = Eigen::MatrixXd::Zero(rows, state.size());
  for (int j = 0; j < columns.width(); ++j) H_x.col(columns.components()[j]) = H_r.col(j);

  Figure figure;
  figure.sources = {"the filter's own Jacobian (backends/msckf/linearization.h) of an example"};
  // One bar for neighbouring nonzero numbers.
  Series nonzero = BarSeries("nonzero", "nonzero", {.colour = kGreen, .opacity = 0.8});
  for (Eigen::Index row = 0; row < rows; ++row) {
    const double y = static_cast<double>(rows - 1 - row);
    for (Eigen::Index begin = 0; begin < H_x.cols();) {
      Eigen::Index end = begin;
      while (end < H_x.cols() && H_x(row, end) != 0.0) ++end;
      if (end > begin) {
        AddBar(static_cast<double>(begin), static_cast<double>(end), y, y + 1.0, &nonzero);
      }
      begin = std::max(end, begin + 1);
    }
  }
  std::vector<Group> groups = {{"state", 0, FilterState::kNavSize}};
  int inertial = 0;
  for (const CalibrationLayout::Entry& entry : state.layout().entries()) {
    if (IsImuBlock(entry.block)) inertial += entry.size;
  }
  groups.push_back({"IMU", FilterState::kNavSize, inertial});
  groups.push_back({"camera", FilterState::kNavSize + inertial, state.layout().size() - inertial});
  for (int clone = 0; clone < kClones; ++clone) {
    groups.push_back({"c" + std::to_string(clone), state.CloneOffset(clone), state.clone_size()});
  }
  const auto height = static_cast<double>(rows);
  Series borders =
      SegmentSeries("borders", "", {.colour = kGrey, .dash = kShortDashed, .width_pt = 0.6});
  Panel panel{.x = {.label = "error state: component",
                    .low = 0.0,
                    .high = static_cast<double>(state.size()),
                    .grid = false},
              .y = {.label = "rows of H_x: pixels", .low = 0.0, .high = height, .grid = false},
              .height_mm = 36.0};
  for (const Group& group : groups) {
    AddSegment(group.first, 0.0, group.first, height, &borders);
    panel.x.ticks.emplace_back(group.first + 0.5 * group.size, group.name);
  }
  for (std::size_t i = 0; i < observations.size(); ++i) {
    AddSegment(0.0, 2.0 * static_cast<double>(i), state.size(), 2.0 * static_cast<double>(i),
               &borders);
    panel.y.ticks.emplace_back(height - 2.0 * static_cast<double>(i) - 1.0,
                               "in c" + std::to_string(observations[i].clone));
  }
  panel.series = {nonzero, borders};
  figure.panels = {panel};
  figure.notes = {
      "state: θ p v b_g b_a; IMU: T_g T_s T_a; camera: p_CB, intrinsics, distortion, t_d, t_r; c0 "
      "to "
      "c5: clones (θ p v). Two rows a pixel. The landmark is anchored in c1: every row depends on "
      "it."};
  return figure;
}

}  // namespace duet
