#include "frontend/anchor_patch.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace duet {
namespace {

constexpr int kIterations = 6;
constexpr double kConverged = 0.015;  // px
constexpr double kMaxStretch = 1.6;   // of any direction, or its inverse
// Grey levels; less is noise, and normalizing it would make a patch of nothing.
constexpr float kMinDeviation = 1.0F;

// Largest and smallest stretch of any direction by A, without an SVD.
bool StretchedBeyondUse(const Eigen::Matrix2d& A) {
  const double mean = 0.5 * A.squaredNorm();
  const double determinant = A.determinant();
  const double spread = std::sqrt(std::max(0.0, mean * mean - determinant * determinant));
  return determinant <= 0.0 || mean + spread > kMaxStretch * kMaxStretch ||
         mean - spread < 1.0 / (kMaxStretch * kMaxStretch);
}

}  // namespace

PatchShape::PatchShape(int half_window_px) : half(half_window_px) {
  const double radius = half + 0.5;
  const double sigma = 0.6 * half;
  std::vector<float> xs;
  std::vector<float> ys;
  std::vector<float> ws;
  for (int row = -half; row <= half; ++row) {
    const int extent = static_cast<int>(std::sqrt(radius * radius - row * row));
    extents.push_back(extent);
    for (int column = -extent; column <= extent; ++column) {
      xs.push_back(static_cast<float>(column));
      ys.push_back(static_cast<float>(row));
      ws.push_back(
          static_cast<float>(std::exp(-0.5 * (row * row + column * column) / (sigma * sigma))));
    }
  }
  while (xs.size() % 4 != 0) {
    xs.push_back(0.0F);
    ys.push_back(0.0F);
    ws.push_back(0.0F);
  }
  const auto count = static_cast<Eigen::Index>(xs.size());
  x = Eigen::Map<Eigen::ArrayXf>(xs.data(), count);
  y = Eigen::Map<Eigen::ArrayXf>(ys.data(), count);
  weights = Eigen::Map<Eigen::ArrayXf>(ws.data(), count);
  weights /= weights.sum();
}

bool AnchorPatch::Take(const PatchShape& shape, const cv::Mat& image, cv::Point2f point) {
  taken_ = false;
  age_ = 0;
  A_.setIdentity();
  const int center_x = cvRound(point.x);
  const int center_y = cvRound(point.y);
  offset_ = Eigen::Vector2d(point.x - static_cast<float>(center_x),
                            point.y - static_cast<float>(center_y));
  const int reach = shape.half + 1;
  if (center_x < reach || center_y < reach || center_x >= image.cols - reach ||
      center_y >= image.rows - reach) {
    return false;
  }
  const Eigen::Index count = shape.x.size();
  patch_.setZero(count);
  sampled_.setZero(count);
  weighted_J_.setZero(count, 8);
  Eigen::Index k = 0;
  for (int y = -shape.half; y <= shape.half; ++y) {
    const int extent = shape.extents[static_cast<std::size_t>(y + shape.half)];
    const unsigned char* row = image.ptr<unsigned char>(center_y + y) + center_x;
    const unsigned char* above = image.ptr<unsigned char>(center_y + y - 1) + center_x;
    const unsigned char* below = image.ptr<unsigned char>(center_y + y + 1) + center_x;
    for (int x = -extent; x <= extent; ++x, ++k) {
      patch_[k] = static_cast<float>(row[x]);
      weighted_J_(k, 0) = 0.5F * static_cast<float>(row[x + 1] - row[x - 1]);
      weighted_J_(k, 1) = 0.5F * static_cast<float>(below[x] - above[x]);
    }
  }
  patch_ -= (shape.weights * patch_).sum();
  const float deviation = std::sqrt((shape.weights * patch_.square()).sum());
  if (deviation < kMinDeviation) return false;
  patch_ /= deviation;
  weighted_J_.leftCols<2>() /= deviation;

  // T((1 + dA) x + dc) ~ T + T_x (dc_x + dA_00 x + dA_01 y) + T_y (...), then contrast, brightness.
  auto J = weighted_J_.array();
  J.col(2) = J.col(0) * shape.x;
  J.col(3) = J.col(0) * shape.y;
  J.col(4) = J.col(1) * shape.x;
  J.col(5) = J.col(1) * shape.y;
  J.col(6) = patch_;
  J.col(7).setOnes();
  const Eigen::Matrix<float, Eigen::Dynamic, 8> unweighted = weighted_J_;
  J.colwise() *= shape.weights;
  Eigen::Matrix<double, 8, 8> H = (weighted_J_.transpose() * unweighted).cast<double>();
  // Keeps what a patch does not fix (a stretch along an edge) from running away.
  H.diagonal().array() += 1e-5;
  H_inverse_ = H.ldlt().solve(Eigen::Matrix<double, 8, 8>::Identity()).cast<float>();
  taken_ = true;
  return true;
}

bool AnchorPatch::Sample(const PatchShape& shape, const cv::Mat& image, const Eigen::Matrix2d& A,
                         const Eigen::Vector2d& center) {
  const double reach_x = shape.half * std::hypot(A(0, 0), A(0, 1)) + 1.0;
  const double reach_y = shape.half * std::hypot(A(1, 0), A(1, 1)) + 1.0;
  if (!(center.x() >= reach_x && center.x() < image.cols - 1 - reach_x && center.y() >= reach_y &&
        center.y() < image.rows - 1 - reach_y)) {
    return false;
  }
  const std::size_t step = image.step[0];
  const auto du = static_cast<float>(A(0, 0));
  const auto dv = static_cast<float>(A(1, 0));
  float* out = sampled_.data();
  for (int y = -shape.half; y <= shape.half; ++y) {
    const int extent = shape.extents[static_cast<std::size_t>(y + shape.half)];
    auto u = static_cast<float>(center.x() + A(0, 1) * y - A(0, 0) * extent);
    auto v = static_cast<float>(center.y() + A(1, 1) * y - A(1, 0) * extent);
    for (int x = -extent; x <= extent; ++x) {
      const int column = static_cast<int>(u);
      const int row = static_cast<int>(v);
      const float fu = u - static_cast<float>(column);
      const float fv = v - static_cast<float>(row);
      const unsigned char* p =
          image.data + static_cast<std::size_t>(row) * step + static_cast<std::size_t>(column);
      const auto above = static_cast<float>(p[0]) + fu * static_cast<float>(p[1] - p[0]);
      const auto below =
          static_cast<float>(p[step]) + fu * static_cast<float>(p[step + 1] - p[step]);
      *out++ = above + fv * (below - above);
      u += du;
      v += dv;
    }
  }
  return true;
}

AnchorPatch::Outcome AnchorPatch::Find(const PatchShape& shape, const cv::Mat& image,
                                       double max_shift_px, double min_correlation,
                                       cv::Point2f* point) {
  if (!taken_) return Outcome::kOutside;
  Eigen::Matrix2d A = A_;
  const Eigen::Vector2d start(point->x, point->y);
  Eigen::Vector2d center = start - A * offset_;
  double correlation = 0.0;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    if (!Sample(shape, image, A, center)) return Outcome::kOutside;
    sampled_ -= (shape.weights * sampled_).sum();
    const float deviation = std::sqrt((shape.weights * sampled_.square()).sum());
    if (deviation < kMinDeviation) return Outcome::kDifferent;
    sampled_ /= deviation;
    correlation = (shape.weights * sampled_ * patch_).sum();
    sampled_ -= patch_;
    const Eigen::Matrix<float, 8, 1> gradient = weighted_J_.transpose() * sampled_.matrix();
    const Eigen::Matrix<double, 8, 1> step = (H_inverse_ * gradient).cast<double>();

    // The image moved by `step` against the patch: x -> A (1 + dA)^-1 (x - dc) + center.
    Eigen::Matrix2d deformation;
    deformation << 1.0 + step[2], step[3], step[4], 1.0 + step[5];
    A = A * deformation.inverse();
    center -= A * step.head<2>();
    if (!((center + A * offset_ - start).norm() <= max_shift_px)) return Outcome::kMoved;
    if (step.head<2>().norm() < kConverged) break;
  }
  if (correlation < min_correlation) return Outcome::kDifferent;
  if (StretchedBeyondUse(A)) return Outcome::kDeformed;
  A_ = A;
  ++age_;
  const Eigen::Vector2d found = center + A * offset_;
  *point = {static_cast<float>(found.x()), static_cast<float>(found.y())};
  return Outcome::kFound;
}

}  // namespace duet
