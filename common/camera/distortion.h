#pragma once

#include <Eigen/Core>
#include <cmath>

namespace duet {

/// The two distortions of CameraModel: maps from a direction (x, y) at z = 1 to the distorted one
/// (d), which the pinhole then takes to pixels. Each has
///
///   Distort    d, and where not null its Jacobians to (x, y) and to the parameters k; any (x, y).
///   MaxRadius  the largest |(x, y)| up to which |d| of the radial part grows; infinity if always.
///   Undistort  the inverse on the branch within max_radius, to 1e-10 in d; false where it fails.

/// d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + tangential part; parameters k1 k2 t1 t2 k3 (OpenCV).
struct RadialTangential {
  static constexpr int kParameters = 5;
  using ParameterJacobian = Eigen::Matrix<double, 2, kParameters>;

  static void Distort(const double* k, const Eigen::Vector2d& x, Eigen::Vector2d* d,
                      Eigen::Matrix2d* J_d_x, ParameterJacobian* J_d_k) {
    const double k1 = k[0], k2 = k[1], t1 = k[2], t2 = k[3], k3 = k[4];
    const double xx = x.x() * x.x();
    const double yy = x.y() * x.y();
    const double xy = x.x() * x.y();
    const double u = xx + yy;
    const double radial = 1.0 + u * (k1 + u * (k2 + u * k3));
    *d << x.x() * radial + 2.0 * t1 * xy + t2 * (u + 2.0 * xx),
        x.y() * radial + t1 * (u + 2.0 * yy) + 2.0 * t2 * xy;
    if (J_d_x != nullptr) {
      const double twice_slope = 2.0 * (k1 + u * (2.0 * k2 + u * 3.0 * k3));
      const double mixed = twice_slope * xy + 2.0 * (t1 * x.x() + t2 * x.y());
      *J_d_x << radial + twice_slope * xx + 2.0 * t1 * x.y() + 6.0 * t2 * x.x(), mixed, mixed,
          radial + twice_slope * yy + 6.0 * t1 * x.y() + 2.0 * t2 * x.x();
    }
    if (J_d_k != nullptr) {
      J_d_k->col(0) = u * x;
      J_d_k->col(1) = (u * u) * x;
      J_d_k->col(2) << 2.0 * xy, u + 2.0 * yy;
      J_d_k->col(3) << u + 2.0 * xx, 2.0 * xy;
      J_d_k->col(4) = (u * u * u) * x;
    }
  }

  static double MaxRadius(const double* k);
  static bool Undistort(const double* k, const Eigen::Vector2d& d, double max_radius,
                        Eigen::Vector2d* x);
};

/// |d| = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8) with tan(theta) = |x|, in
/// the direction of x (Kannala and Brandt 2006, OpenCV's fisheye).
struct Equidistant {
  static constexpr int kParameters = 4;
  using ParameterJacobian = Eigen::Matrix<double, 2, kParameters>;

  static void Distort(const double* k, const Eigen::Vector2d& x, Eigen::Vector2d* d,
                      Eigen::Matrix2d* J_d_x, ParameterJacobian* J_d_k) {
    const double u = x.squaredNorm();
    // f = theta / r as a function of u = r^2, and its derivative: smooth through the axis, where
    // they are the series.
    double f, f_slope;
    ThetaOverRadius(u, &f, &f_slope);
    const double w = u * f * f;  // theta^2
    const double P = 1.0 + w * (k[0] + w * (k[1] + w * (k[2] + w * k[3])));
    const double scale = f * P;
    *d = scale * x;
    if (J_d_x != nullptr) {
      const double P_slope = k[0] + w * (2.0 * k[1] + w * (3.0 * k[2] + w * 4.0 * k[3]));
      // dw/du = f / (1 + u).
      const double twice_slope = 2.0 * (f_slope * P + f * f * P_slope / (1.0 + u));
      const double mixed = twice_slope * x.x() * x.y();
      *J_d_x << scale + twice_slope * x.x() * x.x(), mixed, mixed,
          scale + twice_slope * x.y() * x.y();
    }
    if (J_d_k != nullptr) {
      double factor = f * w;
      for (int i = 0; i < kParameters; ++i) {
        J_d_k->col(i) = factor * x;
        factor *= w;
      }
    }
  }

  static double MaxRadius(const double* k);
  static bool Undistort(const double* k, const Eigen::Vector2d& d, double max_radius,
                        Eigen::Vector2d* x);

 private:
  static void ThetaOverRadius(double u, double* f, double* f_slope) {
    // Below 0.01 the derivative's closed form cancels, and eight terms are exact to rounding.
    if (u < 0.01) {
      *f = 1.0 -
           u * (1.0 / 3 -
                u * (1.0 / 5 -
                     u * (1.0 / 7 - u * (1.0 / 9 - u * (1.0 / 11 - u * (1.0 / 13 - u / 15))))));
      *f_slope = -1.0 / 3 +
                 u * (2.0 / 5 -
                      u * (3.0 / 7 -
                           u * (4.0 / 9 -
                                u * (5.0 / 11 - u * (6.0 / 13 - u * (7.0 / 15 - u * 8.0 / 17))))));
      return;
    }
    const double r = std::sqrt(u);
    *f = std::atan(r) / r;
    *f_slope = (1.0 / (1.0 + u) - *f) / (2.0 * u);
  }
};

}  // namespace duet
