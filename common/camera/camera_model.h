#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace duet {

enum class DistortionModel {
  kRadialTangential,  ///< k1 k2 t1 t2 k3 (OpenCV's order; the thesis writes k1 k2 k3 t1 t2)
  kEquidistant,       ///< k1 k2 k3 k4 (Kannala-Brandt, OpenCV's fisheye)
};

/// Name in files: "radial-tangential" or "equidistant".
[[nodiscard]] const char* DistortionModelName(DistortionModel model);

/// A pinhole camera with distortion (thesis chapter 5; DESIGN.md section 3).
///
/// Points are in C (x right, y down, z forward, m), pixels have their centres at integers (OpenCV's
/// convention). The parameters, in one vector: fx fy ox oy [px], then the distortion in the order
/// of DistortionModel. Projection needs z > 0 and depends on the direction of the point only.
class CameraModel {
 public:
  static constexpr int kMaxParameters = 9;
  static constexpr int kPinholeParameters = 4;
  using Parameters = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxParameters, 1>;
  using Jacobian2x3 = Eigen::Matrix<double, 2, 3>;
  /// Columns beyond parameter_count() are zero.
  using ParameterJacobian = Eigen::Matrix<double, 2, kMaxParameters>;

  CameraModel() = default;
  /// CHECKs the number of parameters.
  CameraModel(DistortionModel model, int width_px, int height_px, const Parameters& parameters);

  [[nodiscard]] DistortionModel model() const { return model_; }
  [[nodiscard]] int width_px() const { return width_px_; }
  [[nodiscard]] int height_px() const { return height_px_; }
  [[nodiscard]] int parameter_count() const { return static_cast<int>(parameters_.size()); }
  [[nodiscard]] int distortion_count() const { return parameter_count() - kPinholeParameters; }
  [[nodiscard]] const Parameters& parameters() const { return parameters_; }
  void set_parameters(const Parameters& parameters);

  /// Pixel of the point p_C (any positive scale). Jacobians are filled where not null: J_uv_p
  /// [px per unit of p_C], J_uv_parameters [px per parameter].
  /// False, and nothing written, for z <= 0 (or not finite).
  [[nodiscard]] bool Project(const Eigen::Vector3d& p_C, Eigen::Vector2d* uv,
                             Jacobian2x3* J_uv_p = nullptr,
                             ParameterJacobian* J_uv_parameters = nullptr) const;

  /// The direction (x, y, 1) that is seen at `uv`, by Newton's method on the distortion. Nothing
  /// where it does not converge to 1e-10 (of the distorted direction, 1) or where no such direction
  /// lies on the branch that contains the optical axis: there the radial distortion still grows
  /// with the angle (max_radius()); further out a second direction has the same pixel.
  [[nodiscard]] std::optional<Eigen::Vector3d> Unproject(const Eigen::Vector2d& uv) const;

  /// The largest sqrt(x^2 + y^2) / z up to which the radial distortion grows with it; infinite
  /// where it always does. Project does not look at it: a point further out still has its formula's
  /// pixel.
  [[nodiscard]] double max_radius() const { return max_radius_; }

  /// True inside [-0.5 - margin, size - 0.5 + margin).
  [[nodiscard]] bool Contains(const Eigen::Vector2d& uv, double margin_px = 0.0) const;

 private:
  DistortionModel model_ = DistortionModel::kRadialTangential;
  int width_px_ = 0;
  int height_px_ = 0;
  double max_radius_ = 0.0;
  Parameters parameters_;
};

}  // namespace duet
