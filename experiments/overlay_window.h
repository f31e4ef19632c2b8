#pragma once

#include <cstdio>
#include <memory>
#include <opencv2/core/mat.hpp>

namespace duet {

/// A window that shows pictures as they come (duet track --show). It is another program,
/// duet_viewer beside this one, fed through a pipe: OpenCV's windows bring a whole GUI stack, which
/// would otherwise stand in the memory of every run that is measured.
class OverlayWindow {
 public:
  /// Throws InputError where there is no display or no viewer was built.
  OverlayWindow();

  /// Does nothing more once the user has closed the window. `picture`: BGR, 8 bit.
  void Show(const cv::Mat& picture);

 private:
  struct Closer {
    void operator()(std::FILE* pipe) const;
  };
  std::unique_ptr<std::FILE, Closer> pipe_;
};

}  // namespace duet
