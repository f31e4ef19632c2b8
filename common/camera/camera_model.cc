#include "common/camera/camera_model.h"

#include <cmath>

#include "common/camera/distortion.h"
#include "common/support/logging.h"

namespace duet {
namespace {

int DistortionCount(DistortionModel model) {
  return model == DistortionModel::kRadialTangential ? 5 : 4;
}

template <typename Distortion>
bool ProjectWith(const double* parameters, const Eigen::Vector3d& p_C, Eigen::Vector2d* uv,
                 CameraModel::Jacobian2x3* J_uv_p,
                 CameraModel::ParameterJacobian* J_uv_parameters) {
  if (!(p_C.z() > 0.0)) return false;
  const double fx = parameters[0];
  const double fy = parameters[1];
  const double* k = parameters + CameraModel::kPinholeParameters;
  const double inverse_z = 1.0 / p_C.z();
  const Eigen::Vector2d x(p_C.x() * inverse_z, p_C.y() * inverse_z);

  Eigen::Vector2d d;
  Eigen::Matrix2d J_d_x;
  typename Distortion::ParameterJacobian J_d_k;
  Distortion::Distort(k, x, &d, J_uv_p ? &J_d_x : nullptr, J_uv_parameters ? &J_d_k : nullptr);
  const Eigen::Vector2d pixel(fx * d.x() + parameters[2], fy * d.y() + parameters[3]);
  // A sum is finite only if its terms are.
  if (!std::isfinite(pixel.x() + pixel.y())) return false;
  *uv = pixel;

  if (J_uv_p != nullptr) {
    const double fx_z = fx * inverse_z;
    const double fy_z = fy * inverse_z;
    J_uv_p->col(0) << fx_z * J_d_x(0, 0), fy_z * J_d_x(1, 0);
    J_uv_p->col(1) << fx_z * J_d_x(0, 1), fy_z * J_d_x(1, 1);
    J_uv_p->col(2) = -x.x() * J_uv_p->col(0) - x.y() * J_uv_p->col(1);
  }
  if (J_uv_parameters != nullptr) {
    auto& J = *J_uv_parameters;
    J.col(0) << d.x(), 0.0;
    J.col(1) << 0.0, d.y();
    J.col(2) << 1.0, 0.0;
    J.col(3) << 0.0, 1.0;
    for (int i = 0; i < Distortion::kParameters; ++i) {
      J.col(4 + i) << fx * J_d_k(0, i), fy * J_d_k(1, i);
    }
    for (int i = 4 + Distortion::kParameters; i < CameraModel::kMaxParameters; ++i) {
      J.col(i).setZero();
    }
  }
  return true;
}

}  // namespace

const char* DistortionModelName(DistortionModel model) {
  switch (model) {
    case DistortionModel::kRadialTangential:
      return "radial-tangential";
    case DistortionModel::kEquidistant:
      return "equidistant";
  }
  return "unknown";
}

CameraModel::CameraModel(DistortionModel model, int width_px, int height_px,
                         const Parameters& parameters)
    : model_(model), width_px_(width_px), height_px_(height_px) {
  CHECK_EQ(parameters.size(), kPinholeParameters + DistortionCount(model))
      << "parameters of a " << DistortionModelName(model) << " camera";
  set_parameters(parameters);
}

void CameraModel::set_parameters(const Parameters& parameters) {
  CHECK_EQ(parameters.size(), kPinholeParameters + DistortionCount(model_))
      << "parameters of a " << DistortionModelName(model_) << " camera";
  parameters_ = parameters;
  const double* k = parameters_.data() + kPinholeParameters;
  max_radius_ = model_ == DistortionModel::kRadialTangential ? RadialTangential::MaxRadius(k)
                                                             : Equidistant::MaxRadius(k);
}

bool CameraModel::Project(const Eigen::Vector3d& p_C, Eigen::Vector2d* uv, Jacobian2x3* J_uv_p,
                          ParameterJacobian* J_uv_parameters) const {
  if (model_ == DistortionModel::kRadialTangential) {
    return ProjectWith<RadialTangential>(parameters_.data(), p_C, uv, J_uv_p, J_uv_parameters);
  }
  return ProjectWith<Equidistant>(parameters_.data(), p_C, uv, J_uv_p, J_uv_parameters);
}

std::optional<Eigen::Vector3d> CameraModel::Unproject(const Eigen::Vector2d& uv) const {
  const Eigen::Vector2d d((uv.x() - parameters_[2]) / parameters_[0],
                          (uv.y() - parameters_[3]) / parameters_[1]);
  const double* k = parameters_.data() + kPinholeParameters;
  Eigen::Vector2d x;
  const bool found = model_ == DistortionModel::kRadialTangential
                         ? RadialTangential::Undistort(k, d, max_radius_, &x)
                         : Equidistant::Undistort(k, d, max_radius_, &x);
  if (!found) return std::nullopt;
  return Eigen::Vector3d(x.x(), x.y(), 1.0);
}

bool CameraModel::Contains(const Eigen::Vector2d& uv, double margin_px) const {
  const double low = -0.5 - margin_px;
  return uv.x() >= low && uv.y() >= low && uv.x() < width_px_ - 0.5 + margin_px &&
         uv.y() < height_px_ - 0.5 + margin_px;
}

}  // namespace duet
