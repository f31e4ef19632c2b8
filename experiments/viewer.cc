// duet_viewer: shows the pictures that come on stdin (int32 rows, int32 columns, BGR bytes) until
// stdin or the user's patience (Escape) ends. Apart from `duet`, which stays free of a GUI stack.

#include <cstdint>
#include <cstdio>
#include <opencv2/core/mat.hpp>
#include <opencv2/highgui.hpp>

int main() {
  constexpr int kEscape = 27;
  constexpr std::int32_t kLargest = 1 << 15;
  std::int32_t size[2];
  while (std::fread(size, sizeof size, 1, stdin) == 1) {
    if (size[0] <= 0 || size[1] <= 0 || size[0] > kLargest || size[1] > kLargest) return 1;
    cv::Mat picture(size[0], size[1], CV_8UC3);
    if (std::fread(picture.data, 3, picture.total(), stdin) != picture.total()) return 1;
    cv::imshow("duet track", picture);
    if (cv::waitKey(1) == kEscape) return 0;
  }
  return 0;
}
