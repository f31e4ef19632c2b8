#include "experiments/gnuplot.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "common/support/input_error.h"

namespace duet {
namespace {

constexpr int kNotInstalled = 127;
constexpr int kNoFolder = 126;

}  // namespace

bool RunGnuplot(const std::filesystem::path& folder, const std::string& script) {
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  if (child == 0) {  // nothing here allocates
    if (chdir(folder.c_str()) != 0) _exit(kNoFolder);
    const int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (null >= 0) dup2(null, STDIN_FILENO);
    // A person's ~/.gnuplot does not enter.
    execlp("gnuplot", "gnuplot", "-d", script.c_str(), static_cast<char*>(nullptr));
    _exit(kNotInstalled);
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw std::runtime_error(std::string("waitpid: ") + std::strerror(errno));
  }
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return true;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNotInstalled) return false;
  throw OutputError(folder / script, "gnuplot could not draw it");
}

}  // namespace duet
