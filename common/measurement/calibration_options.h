#pragma once

#include <string>
#include <utility>
#include <vector>

namespace duet {

/// One block of the calibration in the configuration: fixed at its told value, or estimated.
struct BlockPrior {
  bool estimated = false;
  double sigma = 0.0;

  BlockPrior(double sigma_of_each, std::string block_doc, std::string sigma_unit)
      : sigma(sigma_of_each), doc(std::move(block_doc)), unit(std::move(sigma_unit)) {}

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Choice("state", &estimated, {{"fixed", false}, {"estimated", true}}, {.doc = doc});
    v.Field(
        "sigma", &sigma,
        {.doc = "Prior standard deviation of each of its numbers.", .unit = unit, .min = 1e-12});
  }

  std::string doc;
  std::string unit;
};

/// The distortion, whose numbers differ in size.
struct DistortionPrior : BlockPrior {
  using BlockPrior::BlockPrior;
  double share = 0.0;

  template <class Visitor>
  void Visit(Visitor& v) {
    BlockPrior::Visit(v);
    v.Field(
        "share", &share,
        {.doc = "Added to it (as variances): this share of the number's told value.", .min = 0});
  }
};

/// What fixes the body's orientation against the IMU and the cameras (common/measurement/gauge.h).
enum class ImuFrame { kGyroscope, kAccelerometer, kCamera, kFree };

/// How wrong the calibration is told on purpose, for studies: standard deviations of errors that
/// are drawn, one a number of the block; zero leaves a block as it is.
struct ToldErrors {
  double T_g = 0.0;
  double T_s = 0.0;  ///< rad/s per m/s^2
  double T_a = 0.0;
  double p_CB_m = 0.0;
  double R_CB_rad = 0.0;
  double intrinsics_px = 0.0;
  double distortion = 0.0;
  double distortion_share = 0.0;  ///< of the number's value, added to `distortion` as a variance
  double t_d_s = 0.0;
  double t_r_s = 0.0;

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Field("T_g", &T_g, {.doc = "Of each number of T_g.", .unit = "1", .min = 0});
    v.Field("T_s", &T_s, {.doc = "Of each number of T_s.", .unit = "rad/s per m/s^2", .min = 0});
    v.Field("T_a", &T_a, {.doc = "Of each number of T_a.", .unit = "1", .min = 0});
    v.Field("p_CB_m", &p_CB_m, {.doc = "Of p_CB, per axis.", .unit = "m", .min = 0});
    v.Field("R_CB_rad", &R_CB_rad, {.doc = "Of R_CB, per axis.", .unit = "rad", .min = 0});
    v.Field("intrinsics_px", &intrinsics_px, {.doc = "Of fx fy ox oy.", .unit = "px", .min = 0});
    v.Field("distortion", &distortion,
            {.doc = "Of each distortion number.", .unit = "1", .min = 0});
    v.Field("distortion_share", &distortion_share,
            {.doc = "Of each distortion number, as a share of its value.", .unit = "1", .min = 0});
    v.Field("t_d_s", &t_d_s, {.doc = "Of t_d.", .unit = "s", .min = 0});
    v.Field("t_r_s", &t_r_s, {.doc = "Of t_r.", .unit = "s", .min = 0});
  }
};

/// Known offsets that are added to the told values, for studies; empty: none. A block's numbers in
/// its order; of a camera's block the same for every camera, or one set after another.
struct ToldOffset {
  std::vector<double> T_g;
  std::vector<double> T_s;
  std::vector<double> T_a;
  std::vector<double> p_CB_m;
  std::vector<double> R_CB_rad;
  std::vector<double> intrinsics_px;
  std::vector<double> distortion;
  std::vector<double> t_d_s;
  std::vector<double> t_r_s;

  template <class Visitor>
  void Visit(Visitor& v) {
    const std::string by_rows = "9 numbers, by rows, added to ";
    v.Field("T_g", &T_g, {.doc = by_rows + "T_g.", .unit = "1"});
    v.Field("T_s", &T_s, {.doc = by_rows + "T_s.", .unit = "rad/s per m/s^2"});
    v.Field("T_a", &T_a, {.doc = by_rows + "T_a.", .unit = "1"});
    v.Field("p_CB_m", &p_CB_m, {.doc = "3 numbers a camera, added to p_CB.", .unit = "m"});
    v.Field("R_CB_rad", &R_CB_rad,
            {.doc = "3 numbers a camera: R_CB becomes Exp(offset) R_CB.", .unit = "rad"});
    v.Field("intrinsics_px", &intrinsics_px,
            {.doc = "4 numbers a camera, added to fx fy ox oy.", .unit = "px"});
    v.Field("distortion", &distortion,
            {.doc = "As many numbers a camera as its model has, added to the distortion."});
    v.Field("t_d_s", &t_d_s, {.doc = "1 number, added to t_d.", .unit = "s"});
    v.Field("t_r_s", &t_r_s, {.doc = "1 number, added to t_r.", .unit = "s"});
  }
};

/// Which blocks an estimator estimates, and how well they are known before (1 sigma); the same for
/// every estimator (configuration `shared.calibration`).
struct CalibrationPriors {
  ImuFrame imu_frame = ImuFrame::kGyroscope;
  BlockPrior T_g{0.01, "T_g: scale and misalignment of the gyroscope.", "1"};
  BlockPrior T_s{1e-3, "T_s: what the gyroscope feels of the specific force.", "rad/s per m/s^2"};
  BlockPrior T_a{0.01, "T_a: scale and misalignment of the accelerometer.", "1"};
  BlockPrior p_CB{0.02, "p_CB: where the IMU is, in each camera's frame.", "m"};
  BlockPrior R_CB{0.0175, "R_CB: the orientation of each camera against the IMU.", "rad"};
  BlockPrior intrinsics{5.0, "fx fy ox oy of each camera.", "px"};
  DistortionPrior distortion{0.01, "The distortion of each camera.", "1"};
  BlockPrior t_d{0.01, "t_d: images against the IMU's clock, one for the rig.", "s"};
  BlockPrior t_r{0.02, "t_r: the readout time of a rolling shutter, one for the rig.", "s"};
  std::vector<int> cameras;
  ToldErrors told_errors;
  int told_errors_seed = 1;
  ToldOffset told_offset;

  /// True where a camera's own blocks may be estimated.
  [[nodiscard]] bool Estimates(int camera) const {
    for (const int each : cameras) {
      if (each == camera) return true;
    }
    return cameras.empty();
  }

  template <class Visitor>
  void Visit(Visitor& v) {
    v.Choice("imu_frame", &imu_frame,
             {{"gyroscope", ImuFrame::kGyroscope},
              {"accelerometer", ImuFrame::kAccelerometer},
              {"camera", ImuFrame::kCamera},
              {"free", ImuFrame::kFree}},
             {.doc = "What the body's axes are tied to where T_g, T_a and R_CB are all estimated "
                     "(no measurement tells them apart): gyroscope and accelerometer hold the "
                     "three numbers above the diagonal of T_g or T_a, camera wants R_CB of the "
                     "first camera fixed (the thesis's choice), free ties them to nothing."});
    v.Group("T_g", &T_g, "Gyroscope.");
    v.Group("T_s", &T_s, "Gyroscope, g-sensitivity.");
    v.Group("T_a", &T_a, "Accelerometer.");
    v.Group("p_CB", &p_CB, "Extrinsic translation.");
    v.Group("R_CB", &R_CB, "Extrinsic rotation.");
    v.Group("intrinsics", &intrinsics, "Pinhole.");
    v.Group("distortion", &distortion, "Distortion.");
    v.Group("t_d", &t_d, "Time offset.");
    v.Group("t_r", &t_r, "Readout time.");
    v.Field("cameras", &cameras,
            {.doc = "Cameras whose p_CB, R_CB, intrinsics and distortion are estimated where those "
                    "are; empty: all.",
             .min = 0,
             .max = 15});
    v.Group("told_errors", &told_errors,
            "How wrong the calibration is told on purpose: standard deviations of drawn errors "
            "(of cameras: those listed in `cameras`).");
    v.Field("told_errors_seed", &told_errors_seed,
            {.doc = "Seed of told_errors; a block's errors do not depend on the other blocks.",
             .min = 0});
    v.Group("told_offset", &told_offset,
            "How wrong the calibration is told on purpose: known offsets.");
  }
};

}  // namespace duet
