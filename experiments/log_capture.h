#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "common/support/logging.h"

namespace duet {

/// While it lives, collects what is logged: every line for log.txt, warnings for the manifest.
/// Warnings and errors also go to stderr as one line of the program's own, unless `quiet`.
class LogCapture : public google::LogSink {
 public:
  explicit LogCapture(bool quiet);
  ~LogCapture() override;
  LogCapture(const LogCapture&) = delete;
  LogCapture& operator=(const LogCapture&) = delete;

  void send(google::LogSeverity severity, const char* full_filename, const char* base_filename,
            int line, const google::LogMessageTime& time, const char* message,
            std::size_t length) override;

  /// "I estimation_loop.cc:40] text", a line each; no stamps: the text is the same every time.
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  const bool quiet_;
  mutable std::mutex mutex_;
  std::string text_;
  std::vector<std::string> warnings_;
};

/// glog writes no files of its own and keeps stderr for fatal errors; the rest goes to LogCapture.
/// OpenCV says nothing.
void InitializeLogging(const char* program);

}  // namespace duet
