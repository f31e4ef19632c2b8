#include "frontend/image_source.h"

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <thread>
#include <utility>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/stage_timer.h"

namespace duet {
namespace {

// Empty where the file cannot be read.
cv::Mat DecodeGrey(const std::string& path) {
  try {
    return cv::imread(path, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception&) {  // some damaged headers throw instead of giving nothing
    return {};
  }
}

}  // namespace

/// The thread and its queue. The order of the files is the order of the queue; judging what is
/// missing is left to the reader's thread.
class ImageSource::Decoder {
 public:
  Decoder(const std::vector<ImageFiles>& files, std::size_t queue_length)
      : files_(files), queue_length_(queue_length), thread_([this] { Run(); }) {}

  ~Decoder() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  /// The next stamp's images; an empty list after the last.
  ImageSet Pop() {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] { return !queue_.empty() || done_; });
    if (queue_.empty()) {
      if (failure_) std::rethrow_exception(failure_);
      return {};
    }
    ImageSet set = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    changed_.notify_all();
    return set;
  }

 private:
  void Run() {
    try {
      for (const ImageFiles& files : files_) {
        ImageSet set;
        set.timestamp = files.timestamp;
        const double start_ms = ThreadCpuMs();
        for (const std::string& path : files.paths) set.images.push_back(DecodeGrey(path));
        set.decode_cpu_ms = ThreadCpuMs() - start_ms;
        std::unique_lock<std::mutex> lock(mutex_);
        changed_.wait(lock, [this] { return queue_.size() < queue_length_ || stop_; });
        if (stop_) return;
        queue_.push_back(std::move(set));
        lock.unlock();
        changed_.notify_all();
      }
    } catch (...) {  // out of memory, say: the reader's thread shall hear of it
      const std::lock_guard<std::mutex> lock(mutex_);
      failure_ = std::current_exception();
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    done_ = true;
    changed_.notify_all();
  }

  const std::vector<ImageFiles>& files_;
  const std::size_t queue_length_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ImageSet> queue_;
  std::exception_ptr failure_;
  bool stop_ = false;
  bool done_ = false;
  std::thread thread_;  // last: it uses all of the above
};

ImageSource::ImageSource(std::vector<ImageFiles> files, const RigCalibration& rig, int queue_length)
    : files_(std::move(files)), missing_of_camera_(rig.cameras.size(), 0) {
  CHECK_GE(queue_length, 1);
  for (const CameraCalibration& camera : rig.cameras) {
    sizes_.emplace_back(camera.model.width_px(), camera.model.height_px());
  }
  for (const ImageFiles& files_of_stamp : files_) {
    CHECK_EQ(files_of_stamp.paths.size(), rig.cameras.size());
  }
  decoder_ = std::make_unique<Decoder>(files_, static_cast<std::size_t>(queue_length));
}

ImageSource::~ImageSource() = default;

std::optional<ImageSet> ImageSource::Next() {
  while (true) {
    ImageSet set = decoder_->Pop();
    if (set.images.empty()) return std::nullopt;
    const ImageFiles& files = files_[next_++];
    for (std::size_t camera = 0; camera < set.images.size(); ++camera) {
      Judge(files, static_cast<int>(camera), set.images[camera]);
    }
    if (!set.images[0].empty()) return set;
  }
}

void ImageSource::Judge(const ImageFiles& files, int camera, const cv::Mat& image) {
  const auto index = static_cast<std::size_t>(camera);
  const std::string& path = files.paths[index];
  if (!image.empty()) {
    const cv::Size expected = sizes_[index];
    if (image.size() == expected) return;
    throw InputError(path, 0, "",
                     "the image is " + std::to_string(image.cols) + " x " +
                         std::to_string(image.rows) + " pixels, the calibration of camera " +
                         std::to_string(camera) + " is for " + std::to_string(expected.width) +
                         " x " + std::to_string(expected.height));
  }
  if (next_ == 1) throw InputError(path, 0, "", "the first image is missing or cannot be read");
  dropped_.push_back({files.timestamp, camera, path});
  const int missing = ++missing_of_camera_[index];
  if (20 * static_cast<std::size_t>(missing) > files_.size()) {
    throw InputError(path, 0, "",
                     "more than one image in twenty of camera " + std::to_string(camera) +
                         " is missing or cannot be read (" + std::to_string(missing) + " of " +
                         std::to_string(files_.size()) + " so far)");
  }
  LOG(WARNING) << path << ": cannot be read; the frame at " << files.timestamp << " is dropped";
}

}  // namespace duet
