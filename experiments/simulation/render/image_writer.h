#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <thread>
#include <vector>

namespace duet {

/// The bytes of an 8 bit grey image as PNG: zlib's fastest level on the rows' differences (filter
/// "sub"), Huffman's code alone: a noisy image repeats nothing that longer matches could be found
/// in. A 752 x 480 image of 252 kB takes 3.8 ms, against 10 ms for 245 kB with zlib's level 1. The
/// same image gives the same bytes (with the same libpng and zlib).
[[nodiscard]] std::vector<unsigned char> EncodePng(const cv::Mat& image);

/// Writes images as PNG files in threads of its own; in which order is of no importance. At most a
/// few images wait: Write() blocks while the threads are behind.
class ImageWriter {
 public:
  explicit ImageWriter(int threads);
  /// Ends the threads; what still waits is not written, errors are lost: Finish() first.
  ~ImageWriter();
  ImageWriter(const ImageWriter&) = delete;
  ImageWriter& operator=(const ImageWriter&) = delete;

  /// The pixels must not be changed until Finish(). Throws OutputError for an image before it that
  /// could not be written (a full disk); nothing is written from then on.
  void Write(const cv::Mat& image, const std::filesystem::path& path);

  /// Waits until all is written. Throws OutputError as Write().
  void Finish();

 private:
  struct Job {
    cv::Mat image;
    std::filesystem::path path;
  };
  void Work();
  void ThrowIfFailed();  // with the lock held

  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> waiting_;
  int at_work_ = 0;
  bool stop_ = false;
  std::exception_ptr failure_;
  std::vector<std::thread> threads_;  // last: they use all of the above
};

}  // namespace duet
