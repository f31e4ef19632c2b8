#include "experiments/study/child_pool.h"

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>

#include "experiments/interrupt.h"

namespace duet {
namespace {

sigset_t ChildSignal() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGCHLD);
  return signals;
}

void PinTo(int core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(core, &cores);
  sched_setaffinity(0, sizeof cores, &cores);
}

}  // namespace

ChildPool::ChildPool() {
  // Kept for Wait(): a child that ends before it waits is not missed.
  const sigset_t signals = ChildSignal();
  sigprocmask(SIG_BLOCK, &signals, &mask_before_);
}

ChildPool::~ChildPool() {
  for (const auto& [process, number] : numbers_) kill(process, SIGTERM);
  for (const auto& [process, number] : numbers_) {
    while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  sigprocmask(SIG_SETMASK, &mask_before_, nullptr);
}

void ChildPool::Start(int number, std::optional<int> core, const std::function<int()>& work) {
  // What is buffered would be written twice.
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) {
    sigprocmask(SIG_SETMASK, &mask_before_, nullptr);
    setpgid(0, 0);  // a terminal's Ctrl-C reaches the parent, which passes it on once
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);
    if (core) PinTo(*core);
    const int status = work();
    std::fflush(nullptr);
    _exit(status);
  }
  numbers_[child] = number;
}

std::optional<ChildPool::Ended> ChildPool::Wait(double wait_s) {
  for (const bool is_last : {false, true}) {
    if (Interrupted()) PassOnInterruption();
    if (numbers_.empty()) return std::nullopt;
    int status = 0;
    const pid_t ended = waitpid(-1, &status, WNOHANG);
    if (ended < 0 && errno != EINTR) {
      throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
    }
    const auto found = numbers_.find(ended);
    if (ended > 0 && found != numbers_.end()) {
      Ended result{.number = found->second, .result = {}};
      numbers_.erase(found);
      if (WIFSIGNALED(status)) {
        result.result.signal = WTERMSIG(status);
      } else {
        result.result.exit_status = WEXITSTATUS(status);
      }
      return result;
    }
    if (is_last) break;
    // An interruption ends the wait too.
    const sigset_t signals = ChildSignal();
    const auto whole_s = static_cast<time_t>(wait_s);
    const timespec time = {
        .tv_sec = whole_s,
        .tv_nsec = static_cast<long>((wait_s - static_cast<double>(whole_s)) * 1e9)};
    sigtimedwait(&signals, nullptr, &time);
  }
  return std::nullopt;
}

void ChildPool::PassOnInterruption() {
  if (passed_on_) return;
  passed_on_ = true;
  for (const auto& [process, number] : numbers_) kill(process, SIGINT);
}

}  // namespace duet
