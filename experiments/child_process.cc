#include "experiments/child_process.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "experiments/interrupt.h"

namespace duet {
namespace {

constexpr const char* kSelf = "/proc/self/exe";
constexpr int kExecFailed = 127;
constexpr useconds_t kPollInterval_us = 20000;

/// Between fork and exec: nothing here allocates.
[[noreturn]] void BecomeChild(char* const* argv, std::optional<int> core, pid_t parent) {
  setpgid(0, 0);  // a terminal's Ctrl-C reaches the parent, which passes it on once
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(kExecFailed);
  if (core) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(*core, &cores);
    sched_setaffinity(0, sizeof cores, &cores);
  }
  const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (null >= 0) dup2(null, STDOUT_FILENO);
  execv(kSelf, argv);
  _exit(kExecFailed);
}

}  // namespace

ChildResult RunSelf(const std::vector<std::string>& arguments, std::optional<int> core) {
  std::vector<std::string> words = {"duet"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) BecomeChild(argv.data(), core, parent);

  int status = 0;
  bool passed_on = false;
  for (pid_t ended = 0; ended == 0;) {
    ended = waitpid(child, &status, WNOHANG);
    if (ended < 0 && errno != EINTR) {
      throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
    }
    if (ended > 0) break;
    ended = 0;
    if (Interrupted() && !passed_on) {
      kill(child, SIGINT);
      passed_on = true;
    }
    usleep(kPollInterval_us);
  }
  if (WIFSIGNALED(status)) return {0, WTERMSIG(status)};
  return {WEXITSTATUS(status), 0};
}

std::optional<int> CoreForMeasuring() {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) != 0) return std::nullopt;
  for (int core = CPU_SETSIZE - 1; core >= 0; --core) {
    if (CPU_ISSET(core, &cores)) return core;
  }
  return std::nullopt;
}

}  // namespace duet
