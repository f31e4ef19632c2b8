#include "experiments/simulation/render/image_writer.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/logging.h"

namespace duet {
namespace {

void WriteBytes(const std::vector<unsigned char>& bytes, const std::filesystem::path& path) {
  const auto fail = [&path] { throw OutputError(path.string(), std::strerror(errno)); };
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Closer> file(std::fopen(path.c_str(), "wb"));
  if (!file) fail();
  if (std::fwrite(bytes.data(), 1, bytes.size(), file.get()) != bytes.size()) fail();
  // A full disk may show only now.
  if (std::fclose(file.release()) != 0) fail();
}

}  // namespace

std::vector<unsigned char> EncodePng(const cv::Mat& image) {
  CHECK_EQ(image.type(), CV_8UC1);
  CHECK(!image.empty());
  std::vector<unsigned char> bytes;
  // Without a level of one's own OpenCV takes Z_BEST_SPEED and the filter "sub".
  CHECK(cv::imencode(".png", image, bytes,
                     {cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY}));
  return bytes;
}

ImageWriter::ImageWriter(int threads) : capacity_(2 * static_cast<std::size_t>(threads)) {
  CHECK_GT(threads, 0);
  for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { Work(); });
}

ImageWriter::~ImageWriter() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    waiting_.clear();
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ImageWriter::ThrowIfFailed() {
  if (failure_) std::rethrow_exception(failure_);
}

void ImageWriter::Write(const cv::Mat& image, const std::filesystem::path& path) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return waiting_.size() < capacity_ || failure_; });
  ThrowIfFailed();
  waiting_.push_back({image, path});
  changed_.notify_all();
}

void ImageWriter::Finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return (waiting_.empty() && at_work_ == 0) || failure_; });
  ThrowIfFailed();
}

void ImageWriter::Work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return stop_ || !waiting_.empty(); });
    if (stop_) return;
    const Job job = std::move(waiting_.front());
    waiting_.pop_front();
    ++at_work_;
    lock.unlock();
    std::exception_ptr failure;
    try {
      WriteBytes(EncodePng(job.image), job.path);
    } catch (const OutputError&) {
      failure = std::current_exception();
    }
    lock.lock();
    --at_work_;
    if (failure && !failure_) {
      failure_ = failure;
      waiting_.clear();
    }
    changed_.notify_all();
  }
}

}  // namespace duet
