#include "experiments/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace duet {
namespace {

constexpr double kTerminalInterval_s = 0.2;
constexpr double kPlainInterval_s = 5.0;

bool terminal_line_open = false;

void CloseTerminalLine() {
  if (terminal_line_open) std::fputs("\r\033[K", stderr);
  terminal_line_open = false;
}

}  // namespace

Progress::Progress(std::string label, std::int64_t total, std::string unit, bool quiet)
    : label_(std::move(label)),
      total_(total),
      unit_(std::move(unit)),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {}

Progress::~Progress() { CloseTerminalLine(); }

double Progress::Elapsed() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

void Progress::Update(std::int64_t done) {
  done_ = done;
  if (quiet_) return;
  const double elapsed_s = Elapsed();
  if (elapsed_s - last_printed_s_ < (terminal_ ? kTerminalInterval_s : kPlainInterval_s)) return;
  last_printed_s_ = elapsed_s;
  const double left_s =
      done > 0 ? elapsed_s * static_cast<double>(total_ - done) / static_cast<double>(done) : 0.0;
  std::fprintf(stderr, "%s%s: %lld of %lld %s, %.0f s left%s", terminal_ ? "\r\033[K" : "",
               label_.c_str(), static_cast<long long>(done), static_cast<long long>(total_),
               unit_.c_str(), left_s, terminal_ ? "" : "\n");
  std::fflush(stderr);
  terminal_line_open = terminal_;
}

void Progress::Finish(const std::string& note) {
  if (quiet_) return;
  CloseTerminalLine();
  std::fprintf(stderr, "%s: %lld %s in %.1f s%s\n", label_.c_str(), static_cast<long long>(done_),
               unit_.c_str(), Elapsed(), note.empty() ? "" : (", " + note).c_str());
  quiet_ = true;
}

void PrintWarning(const std::string& text) {
  CloseTerminalLine();
  std::fprintf(stderr, "duet: warning: %s\n", text.c_str());
}

}  // namespace duet
