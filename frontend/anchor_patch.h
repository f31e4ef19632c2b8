#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace duet {

/// The pixels of a round patch, in rows, with weights that fall off from its centre. Their number
/// is padded to a multiple of four by pixels without weight.
struct PatchShape {
  explicit PatchShape(int half_window_px);

  int half = 0;
  std::vector<int> extents;  ///< row y = -half ... half reaches from x = -extent to +extent
  Eigen::ArrayXf x;          ///< offsets from the centre, px
  Eigen::ArrayXf y;
  Eigen::ArrayXf weights;  ///< sum 1
};

/// The patch of the image in which a track was first seen, and where it lies in the newest one.
///
/// Flow from frame to frame adds its small errors up: tracks wander off their points by a pixel
/// within a second. Here the patch itself is found again, deformed by an affine map, near where the
/// flow says that the point is (Shi and Tomasi, "Good features to track", 1994): errors do not add
/// up, and a patch that no longer looks like itself (an edge in front of another depth, an
/// occlusion, a reflection) is found out.
///
/// Inverse compositional Gauss-Newton (Baker and Matthews, "Lucas-Kanade 20 years on", 2004) on
/// intensities normalized to mean 0 and deviation 1 within the patch, so that exposure and gain do
/// not matter: with x in the patch, T the patch and I the image, both normalized,
///
///   minimize sum w(x) (I(A x + c) - T(x))^2   over c, A (and contrast, brightness)
///
/// The gradients of T and the inverse of its 8 x 8 normal matrix are taken once; an iteration
/// samples the image and multiplies.
class AnchorPatch {
 public:
  enum class Outcome {
    kFound,
    kDifferent,  ///< does not look like the patch
    kMoved,      ///< is not where the flow said
    kDeformed,   ///< stretched beyond use: the patch should be taken anew
    kOutside,    ///< reaches over the image's edge
  };

  /// Takes the patch around `point` of `image` (8 bit grey); false, and nothing to be found from
  /// then on, where the image's edge is too near.
  bool Take(const PatchShape& shape, const cv::Mat& image, cv::Point2f point);

  /// Looks for the patch in `image` near `*point`, starting from the last affine map, and corrects
  /// `*point` where it is found: no further than `max_shift_px` from the start, with a correlation
  /// of at least `min_correlation`. Otherwise nothing changes.
  [[nodiscard]] Outcome Find(const PatchShape& shape, const cv::Mat& image, double max_shift_px,
                             double min_correlation, cv::Point2f* point);

  /// Frames in which the patch was found since it was taken.
  [[nodiscard]] int age() const { return age_; }

 private:
  bool Sample(const PatchShape& shape, const cv::Mat& image, const Eigen::Matrix2d& A,
              const Eigen::Vector2d& center);

  bool taken_ = false;
  int age_ = 0;
  Eigen::Vector2d offset_ = Eigen::Vector2d::Zero();  // of the point from the patch's central pixel
  Eigen::Matrix2d A_ = Eigen::Matrix2d::Identity();   // patch to newest image
  Eigen::ArrayXf patch_;                              // normalized
  Eigen::Matrix<float, Eigen::Dynamic, 8> weighted_J_;
  Eigen::Matrix<float, 8, 8> H_inverse_;
  Eigen::ArrayXf sampled_;  // scratch
};

}  // namespace duet
