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

constexpr useconds_t kChildPoll_us = 2000;

void PinTo(int core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(core, &cores);
  sched_setaffinity(0, sizeof cores, &cores);
}

}  // namespace

ChildPool::~ChildPool() {
  for (const auto& [process, number] : numbers_) kill(process, SIGTERM);
  for (const auto& [process, number] : numbers_) {
    while (waitpid(process, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
}

void ChildPool::Start(int number, std::optional<int> core, const std::function<int()>& work) {
  // What is buffered would be written twice.
  std::fflush(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) {
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
  const int polls = static_cast<int>(wait_s * 1e6 / kChildPoll_us) + 1;
  for (int poll = 0; poll < polls && !numbers_.empty(); ++poll) {
    if (Interrupted()) PassOnInterruption();
    int status = 0;
    const pid_t ended = waitpid(-1, &status, WNOHANG);
    if (ended < 0 && errno != EINTR) {
      throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
    }
    const auto found = numbers_.find(ended);
    if (ended <= 0 || found == numbers_.end()) {
      usleep(kChildPoll_us);
      continue;
    }
    Ended result{.number = found->second, .result = {}};
    numbers_.erase(found);
    if (WIFSIGNALED(status)) {
      result.result.signal = WTERMSIG(status);
    } else {
      result.result.exit_status = WEXITSTATUS(status);
    }
    return result;
  }
  return std::nullopt;
}

void ChildPool::PassOnInterruption() {
  if (passed_on_) return;
  passed_on_ = true;
  for (const auto& [process, number] : numbers_) kill(process, SIGINT);
}

}  // namespace duet
