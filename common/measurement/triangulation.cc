#include "common/measurement/triangulation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace duet {
namespace {

// Origin and unit direction in G of one observation's ray.
struct Ray {
  Eigen::Vector3d origin_G;
  Eigen::Vector3d direction_G;
};

// The ray of an observation at its state's instant; the shift by tau is left to the refinement.
bool RayOf(const RigCalibration& rig, const TrackObservationInState& o, Ray* ray) {
  const CameraCalibration& camera = rig.cameras[o.observation.camera];
  const auto direction_C = camera.model.Unproject(o.observation.uv);
  if (!direction_C) return false;
  const Eigen::Quaterniond R_GC = o.state.nav.R_GB * camera.R_CB.conjugate();
  ray->direction_G = R_GC * direction_C->normalized();
  ray->origin_G = o.state.nav.p_GB - R_GC * camera.p_CB;
  return true;
}

// Sum of squared reprojection errors [px^2], and the normal equations where asked for; negative
// where a point falls behind a camera.
double Cost(const RigCalibration& rig, std::span<const TrackObservationInState> observations,
            const Pose& anchor_T_GB, const Eigen::Vector3d& g_G, const InverseDepth& landmark,
            Eigen::Matrix3d* H, Eigen::Vector3d* b) {
  double cost = 0.0;
  if (H != nullptr) {
    H->setZero();
    b->setZero();
  }
  ObservationJacobians jacobians;
  for (const TrackObservationInState& o : observations) {
    Eigen::Vector2d uv;
    if (!PredictPixel(rig, anchor_T_GB, landmark, o.state, o.observation, g_G, &uv,
                      H != nullptr ? &jacobians : nullptr)) {
      return -1.0;
    }
    const Eigen::Vector2d r = o.observation.uv - uv;
    cost += r.squaredNorm();
    if (H != nullptr) {
      H->noalias() += jacobians.landmark.transpose() * jacobians.landmark;
      b->noalias() += jacobians.landmark.transpose() * r;
    }
  }
  return cost;
}

// Levenberg-Marquardt on pixels; false where it does not settle.
bool Refine(const RigCalibration& rig, std::span<const TrackObservationInState> observations,
            const Pose& anchor_T_GB, const Eigen::Vector3d& g_G, int max_iterations,
            InverseDepth* landmark, double* cost) {
  Eigen::Matrix3d H;
  Eigen::Vector3d b;
  *cost = Cost(rig, observations, anchor_T_GB, g_G, *landmark, &H, &b);
  if (*cost < 0.0) return false;
  double lambda = 1e-6;
  for (int i = 0; i < max_iterations; ++i) {
    Eigen::Matrix3d damped = H;
    damped.diagonal() += lambda * H.diagonal();
    const Eigen::Vector3d step = damped.ldlt().solve(b);
    if (!step.allFinite()) return false;
    const InverseDepth candidate = *landmark + step;
    Eigen::Matrix3d H_new;
    Eigen::Vector3d b_new;
    const double cost_new = Cost(rig, observations, anchor_T_GB, g_G, candidate, &H_new, &b_new);
    if (cost_new >= 0.0 && cost_new <= *cost) {
      // Settled when the model itself promises less than a millionth of the cost (or 1e-12 px^2).
      const bool settled = step.dot(b) < std::max(1e-6 * *cost, 1e-12);
      *landmark = candidate;
      *cost = cost_new;
      H = H_new;
      b = b_new;
      lambda = std::max(lambda * 0.1, 1e-12);
      if (settled) return true;
    } else {
      if (step.dot(b) < 1e-9 * *cost + 1e-12) return true;  // at the bottom, up to rounding
      lambda *= 10.0;
    }
  }
  // Not settled to the last digit, but no longer moving by more than a hundredth of a pixel's
  // worth.
  return b.dot(H.ldlt().solve(b)) < 1e-2;
}

}  // namespace

const char* TriangulationStatusName(TriangulationStatus status) {
  switch (status) {
    case TriangulationStatus::kOk:
      return "ok";
    case TriangulationStatus::kTooFewObservations:
      return "too few observations";
    case TriangulationStatus::kNoParallax:
      return "no parallax";
    case TriangulationStatus::kBehindCamera:
      return "behind a camera";
    case TriangulationStatus::kNotConverged:
      return "not converged";
    case TriangulationStatus::kTooNear:
      return "too near";
    case TriangulationStatus::kTooFar:
      return "too far";
    case TriangulationStatus::kLargeResidual:
      return "large residual";
  }
  return "unknown";
}

TriangulationStatus Triangulate(const RigCalibration& rig,
                                std::span<const TrackObservationInState> observations,
                                const Pose& anchor_T_GB, const Eigen::Vector3d& g_G,
                                const TriangulationOptions& options, InverseDepth* landmark) {
  if (observations.size() < 2) return TriangulationStatus::kTooFewObservations;

  // Point nearest to all rays; the cosine of the widest angle against the first and the last ray.
  Ray first;
  Ray last;
  if (!RayOf(rig, observations.front(), &first) || !RayOf(rig, observations.back(), &last)) {
    return TriangulationStatus::kNotConverged;
  }
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  double sin2_widest = 0.0;
  for (const TrackObservationInState& o : observations) {
    Ray ray;
    if (!RayOf(rig, o, &ray)) return TriangulationStatus::kNotConverged;
    const Eigen::Matrix3d projector =
        Eigen::Matrix3d::Identity() - ray.direction_G * ray.direction_G.transpose();
    A += projector;
    c += projector * (ray.origin_G - anchor_T_GB.p);
    sin2_widest = std::max({sin2_widest, ray.direction_G.cross(first.direction_G).squaredNorm(),
                            ray.direction_G.cross(last.direction_G).squaredNorm()});
  }
  const double sin_min = std::sin(options.min_parallax_rad);
  if (sin2_widest < sin_min * sin_min) return TriangulationStatus::kNoParallax;
  const Eigen::Vector3d p_G = anchor_T_GB.p + A.ldlt().solve(c);
  InverseDepth estimate;
  if (!p_G.allFinite() || !LandmarkFromGlobal(rig, anchor_T_GB, p_G, &estimate)) {
    return TriangulationStatus::kBehindCamera;
  }

  double cost = 0.0;
  if (!Refine(rig, observations, anchor_T_GB, g_G, options.max_iterations, &estimate, &cost)) {
    return cost < 0.0 ? TriangulationStatus::kBehindCamera : TriangulationStatus::kNotConverged;
  }
  if (estimate.z() * options.max_depth_m < 1.0) return TriangulationStatus::kTooFar;
  if (estimate.z() * options.min_depth_m > 1.0) return TriangulationStatus::kTooNear;
  if (cost > options.max_rms_px * options.max_rms_px * static_cast<double>(observations.size())) {
    return TriangulationStatus::kLargeResidual;
  }
  *landmark = estimate;
  return TriangulationStatus::kOk;
}

}  // namespace duet
