#include "experiments/log_capture.h"

#include <opencv2/core/utils/logger.hpp>

#include "experiments/progress.h"

namespace duet {

LogCapture::LogCapture(bool quiet) : quiet_(quiet) { google::AddLogSink(this); }

LogCapture::~LogCapture() { google::RemoveLogSink(this); }

void LogCapture::send(google::LogSeverity severity, const char* /*full_filename*/,
                      const char* base_filename, int line, const google::LogMessageTime& /*time*/,
                      const char* message, std::size_t length) {
  const std::string what(message, length);
  const std::lock_guard<std::mutex> lock(mutex_);
  text_ += std::string(1, google::GetLogSeverityName(severity)[0]) + " " + base_filename + ":" +
           std::to_string(line) + "] " + what + "\n";
  if (severity < google::GLOG_WARNING) return;
  warnings_.push_back(what);
  if (!quiet_) PrintWarning(what);
}

std::string LogCapture::text() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return text_;
}

std::vector<std::string> LogCapture::warnings() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return warnings_;
}

void InitializeLogging(const char* program) {
  google::InitGoogleLogging(program);
  for (const google::LogSeverity severity :
       {google::GLOG_INFO, google::GLOG_WARNING, google::GLOG_ERROR, google::GLOG_FATAL}) {
    google::SetLogDestination(severity, "");
  }
  FLAGS_stderrthreshold = google::GLOG_FATAL;
  // What OpenCV would say of an unreadable image, the image source says.
  cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

}  // namespace duet
