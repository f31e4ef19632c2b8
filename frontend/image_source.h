#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "common/measurement/calibration.h"
#include "common/support/timestamp.h"

namespace duet {

/// The image files of one stamp, one a camera of the rig, in its order.
struct ImageFiles {
  Timestamp timestamp = 0;
  std::vector<std::string> paths;
};

/// The decoded images of one stamp, 8 bit grey. Further cameras' images may be empty (unreadable).
struct ImageSet {
  Timestamp timestamp = 0;
  std::vector<cv::Mat> images;
  double decode_cpu_ms = 0.0;  ///< of the decoding thread, for timing.csv
};

/// An image that could not be read, in order of time.
struct DroppedImage {
  Timestamp timestamp = 0;
  int camera = 0;
  std::string path;
};

/// Decodes images ahead in a thread of its own; a bounded queue keeps their order, so that what
/// comes out does not depend on the thread.
///
/// An image that cannot be read is dropped and counted: with the first camera's image the whole
/// stamp goes, else that camera's image is empty. It is an InputError, thrown by Next() when its
/// turn comes, for an image of the first stamp, for more than one image in twenty of a camera, and
/// for an image of another size than the calibration's.
class ImageSource {
 public:
  /// `queue_length` stamps at most are decoded ahead.
  ImageSource(std::vector<ImageFiles> files, const RigCalibration& rig, int queue_length = 8);
  ~ImageSource();
  ImageSource(const ImageSource&) = delete;
  ImageSource& operator=(const ImageSource&) = delete;

  /// The next stamp whose first camera's image could be read; nothing after the last.
  [[nodiscard]] std::optional<ImageSet> Next();

  /// Those met so far by Next().
  [[nodiscard]] const std::vector<DroppedImage>& dropped() const { return dropped_; }

 private:
  class Decoder;

  /// Counts an image that is missing; throws where that, or an image's size, is bad input.
  void Judge(const ImageFiles& files, int camera, const cv::Mat& image);

  std::vector<ImageFiles> files_;
  std::vector<cv::Size> sizes_;
  std::vector<int> missing_of_camera_;
  std::size_t next_ = 0;
  std::vector<DroppedImage> dropped_;
  std::unique_ptr<Decoder> decoder_;  // reads files_: goes first
};

}  // namespace duet
