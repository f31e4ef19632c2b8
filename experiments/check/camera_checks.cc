#include "experiments/check/camera_checks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/geometry/angle.h"
#include "experiments/check/stamp_checks.h"

namespace duet {
namespace {

void CheckCamera(const CameraCalibration& camera, const std::string& name, Findings* findings) {
  const CameraModel& model = camera.model;
  const auto& p = model.parameters();
  const double fx = p[0];
  const double fy = p[1];
  const double width = model.width_px();
  const double height = model.height_px();
  const double view_deg = 2.0 * std::atan2(0.5 * width, fx) * kDegreesPerRadian;
  findings->push_back({Severity::kInfo,
                       name + ".calibration",
                       Sentence("%s: %d x %d px, f = %.1f, %.1f px (%.0f deg across without "
                                "distortion), %.1f cm from the IMU",
                                name.c_str(), model.width_px(), model.height_px(), fx, fy, view_deg,
                                100.0 * camera.p_CB.norm()),
                       "",
                       {{"view_deg", view_deg}, {"distance_m", camera.p_CB.norm()}}});
  if (fx <= 0.0 || fy <= 0.0 || view_deg < 15.0 || view_deg > 170.0) {
    findings->push_back({Severity::kError,
                         name + ".focal_length",
                         Sentence("%s: focal lengths %.1f, %.1f px cannot belong to an image of "
                                  "%.0f x %.0f px",
                                  name.c_str(), fx, fy, width, height),
                         "Were intrinsics and resolution taken at the same image size? Halving the "
                         "image halves fx fy ox oy.",
                         {{"fx_px", fx}, {"fy_px", fy}}});
  } else if (std::abs(fx / fy - 1.0) > 0.1) {
    findings->push_back({Severity::kWarning,
                         name + ".aspect",
                         Sentence("%s: fx / fy is %.3f", name.c_str(), fx / fy),
                         "Pixels are square in almost every camera: check the order fx fy ox oy.",
                         {{"aspect", fx / fy}}});
  }
  const double off_x = std::abs(p[2] - 0.5 * (width - 1.0)) / width;
  const double off_y = std::abs(p[3] - 0.5 * (height - 1.0)) / height;
  if (off_x > 0.15 || off_y > 0.15) {
    const bool outside = off_x > 0.5 || off_y > 0.5;
    findings->push_back(
        {outside ? Severity::kError : Severity::kWarning,
         name + ".principal_point",
         Sentence("%s: the principal point (%.1f, %.1f) is %.0f %% of the image off "
                  "its centre",
                  name.c_str(), p[2], p[3], 100.0 * std::max(off_x, off_y)),
         "Cropped or resized images need their own intrinsics.",
         {{"ox_px", p[2]}, {"oy_px", p[3]}}});
  }
  int folded = 0;
  for (const double u : {0.0, width - 1.0}) {
    for (const double v : {0.0, height - 1.0}) folded += model.Unproject({u, v}) ? 0 : 1;
  }
  if (folded > 0) {
    findings->push_back(
        {Severity::kWarning,
         name + ".distortion",
         Sentence("%s: at %d of 4 corners the distortion has no inverse", name.c_str(), folded),
         "The distortion was fitted without points near the corners, or its order "
         "(k1 k2 t1 t2 k3) or model is another.",
         {{"corners", static_cast<double>(folded)}}});
  }
  if (camera.p_CB.norm() > 1.0) {
    findings->push_back({Severity::kWarning,
                         name + ".lever_arm",
                         Sentence("%s: %.2f m from the IMU", name.c_str(), camera.p_CB.norm()),
                         "Check the unit (mm?) and the direction of T_BS: it takes points of the "
                         "camera into the body frame.",
                         {{"distance_m", camera.p_CB.norm()}}});
  }
}

void CheckPair(const CameraCalibration& a, const CameraCalibration& b, Findings* findings) {
  const Eigen::Quaterniond R_BA = b.R_CB * a.R_CB.conjugate();
  const Eigen::Vector3d baseline = b.p_CB - R_BA * a.p_CB;  // origin of a in b
  const double angle_deg = R_BA.angularDistance(Eigen::Quaterniond::Identity()) * kDegreesPerRadian;
  findings->push_back({Severity::kInfo,
                       "cameras.baseline",
                       Sentence("baseline %.4f m, the second camera turned by %.2f deg against the "
                                "first",
                                baseline.norm(), angle_deg),
                       "",
                       {{"baseline_m", baseline.norm()}, {"rotation_deg", angle_deg}}});
  if (baseline.norm() < 0.005 || baseline.norm() > 1.0) {
    findings->push_back({baseline.norm() < 1e-6 ? Severity::kError : Severity::kWarning,
                         "cameras.baseline_size",
                         Sentence("a baseline of %.4f m is hardly a stereo rig", baseline.norm()),
                         "Check that the two T_BS differ, and their unit.",
                         {{"baseline_m", baseline.norm()}}});
  }
  if (angle_deg > 45.0) {
    findings->push_back({Severity::kWarning,
                         "cameras.rotation",
                         Sentence("the cameras look %.0f deg apart", angle_deg),
                         "Their images hardly overlap: is one T_BS the inverse of what it should "
                         "be?",
                         {{"rotation_deg", angle_deg}}});
  }
}

}  // namespace

Findings CheckCalibration(const RigCalibration& rig, const std::vector<int>& camera_numbers) {
  Findings findings;
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) {
    CheckCamera(rig.cameras[k], "cam" + std::to_string(camera_numbers[k]), &findings);
  }
  if (rig.cameras.size() == 2) CheckPair(rig.cameras[0], rig.cameras[1], &findings);
  if (std::abs(rig.t_d_s) > 0.1 || std::abs(rig.t_r_s) > 0.1) {
    findings.push_back({Severity::kWarning,
                        "cameras.time",
                        Sentence("told time offset %.3f s, readout %.3f s", rig.t_d_s, rig.t_r_s),
                        "More than 0.1 s: check the unit.",
                        {{"t_d_s", rig.t_d_s}, {"t_r_s", rig.t_r_s}}});
  }
  return findings;
}

Findings CheckTracks(const std::vector<TrackFrameSet>& frames, const RigCalibration& rig,
                     long renamed_ids) {
  Findings findings;
  if (frames.empty()) return findings;
  std::map<std::uint64_t, int> lengths;
  long observations = 0;
  long outside = 0;
  int empty = 0;
  for (const TrackFrameSet& set : frames) {
    for (const TrackFrame& frame : set.frames) {
      const CameraModel& model = rig.cameras[static_cast<std::size_t>(frame.camera)].model;
      if (frame.observations.empty()) ++empty;
      for (const TrackObservation& observation : frame.observations) {
        ++observations;
        if (!model.Contains({observation.u, observation.v}, 5.0)) ++outside;
        if (frame.camera == 0) ++lengths[observation.track_id];
      }
    }
  }
  double in_first = 0.0;
  for (const auto& [id, length] : lengths) in_first += length;
  const double mean_length = lengths.empty() ? 0.0 : in_first / static_cast<double>(lengths.size());
  const double per_frame = in_first / static_cast<double>(frames.size());
  findings.push_back(
      {Severity::kInfo,
       "tracks",
       Sentence("%zu tracks in the first camera, %.1f a frame, each %.1f frames long "
                "on average; %ld ids came again and were renamed",
                lengths.size(), per_frame, mean_length, renamed_ids),
       "",
       {{"tracks", static_cast<double>(lengths.size())},
        {"per_frame", per_frame},
        {"mean_length_frames", mean_length}}});
  if (outside * 1000 > observations) {
    findings.push_back(
        {Severity::kWarning,
         "tracks.outside",
         Sentence("%.2f %% of the observations lie more than 5 px outside the image",
                  100.0 * static_cast<double>(outside) / static_cast<double>(observations)),
         "Are these pixels raw (distorted), and of this image size?",
         {{"share", static_cast<double>(outside) / static_cast<double>(observations)}}});
  }
  if (empty > 0) {
    findings.push_back({Severity::kWarning,
                        "tracks.empty",
                        std::to_string(empty) + " frames have no observation",
                        "An estimator has only the IMU there.",
                        {{"frames", static_cast<double>(empty)}}});
  }
  if (mean_length < 4.0) {
    findings.push_back({Severity::kWarning,
                        "tracks.short",
                        Sentence("tracks are %.1f frames long on average", mean_length),
                        "Hardly any can be triangulated: are ids kept from frame to frame?",
                        {{"mean_length_frames", mean_length}}});
  }
  return findings;
}

}  // namespace duet
