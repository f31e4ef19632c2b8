#include "experiments/simulation/warp_difference.h"

#include <cmath>
#include <cstdint>

#include "common/support/logging.h"
#include "experiments/simulation/depth_edge.h"

namespace duet {
namespace {

constexpr double kEdgeDistance_px = 3.0;
constexpr double kBorder_px = 2.0;  // that the interpolation reaches

void CatmullRomWeights(double x, double* weights) {
  const double x2 = x * x;
  const double x3 = x2 * x;
  weights[0] = 0.5 * (-x3 + 2.0 * x2 - x);
  weights[1] = 0.5 * (3.0 * x3 - 5.0 * x2 + 2.0);
  weights[2] = 0.5 * (-3.0 * x3 + 4.0 * x2 + x);
  weights[3] = 0.5 * (x3 - x2);
}

double Interpolate(const cv::Mat& image, const Eigen::Vector2d& uv) {
  const int u = static_cast<int>(std::floor(uv.x()));
  const int v = static_cast<int>(std::floor(uv.y()));
  double by_u[4], by_v[4];
  CatmullRomWeights(uv.x() - u, by_u);
  CatmullRomWeights(uv.y() - v, by_v);
  double sum = 0.0;
  for (int j = 0; j < 4; ++j) {
    const std::uint8_t* row = image.ptr<std::uint8_t>(v - 1 + j) + u - 1;
    for (int i = 0; i < 4; ++i) sum += by_v[j] * by_u[i] * row[i];
  }
  return sum;
}

}  // namespace

WarpDifference CompareByWarp(const TrueCamera& truth, int camera, Timestamp from,
                             const cv::Mat& from_image, Timestamp to, const cv::Mat& to_image,
                             int step) {
  const CameraModel& model = truth.model(camera);
  CHECK_EQ(from_image.type(), CV_8UC1);
  CHECK_EQ(to_image.type(), CV_8UC1);
  CHECK_GT(step, 0);
  for (const cv::Mat* image : {&from_image, &to_image}) {
    CHECK_EQ(image->cols, model.width_px());
    CHECK_EQ(image->rows, model.height_px());
  }
  WarpDifference difference;
  int looked_at = 0;
  double sum = 0.0;
  double squares = 0.0;
  for (int v = 0; v < to_image.rows; v += step) {
    for (int u = 0; u < to_image.cols; u += step) {
      ++looked_at;
      const Eigen::Vector2d to_uv(u, v);
      const auto point = truth.PointAt(camera, to, to_uv);
      if (!point || NearDepthEdge(truth, camera, to, to_uv, kEdgeDistance_px)) continue;
      const auto from_uv = truth.PixelOf(camera, from, *point);
      if (!from_uv || !model.Contains(*from_uv, -kBorder_px)) continue;
      if (!truth.IsVisible(camera, from, *point, *from_uv)) continue;
      if (NearDepthEdge(truth, camera, from, *from_uv, kEdgeDistance_px)) continue;
      const double grey = to_image.at<std::uint8_t>(v, u) - Interpolate(from_image, *from_uv);
      ++difference.compared;
      sum += grey;
      squares += grey * grey;
    }
  }
  difference.share = static_cast<double>(difference.compared) / looked_at;
  if (difference.compared > 0) {
    difference.mean_grey = sum / difference.compared;
    difference.rms_grey = std::sqrt(squares / difference.compared);
  }
  return difference;
}

}  // namespace duet
