#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace duet {

/// One line on stderr that says how far long work is and how long the rest will take: rewritten in
/// place on a terminal, else a plain line every few seconds. The clock it reads is for the reader
/// of the line only.
class Progress {
 public:
  /// `unit`: what is counted, "frames". Prints nothing where `quiet`.
  Progress(std::string label, std::int64_t total, std::string unit, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Update(std::int64_t done);
  /// The last line: "label: 320 frames in 2.1 s", and what else there is to say.
  void Finish(const std::string& note = "");

 private:
  [[nodiscard]] double Elapsed() const;

  std::string label_;
  std::int64_t total_;
  std::string unit_;
  bool quiet_;
  bool terminal_;
  std::int64_t done_ = 0;
  std::chrono::steady_clock::time_point start_;
  double last_printed_s_ = 0.0;
};

/// One plain line on stderr, "duet: warning: text"; the same channel as the progress line.
void PrintWarning(const std::string& text);

}  // namespace duet
