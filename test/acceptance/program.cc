#include "test/acceptance/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace duet {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void BecomeProgram(std::vector<std::string> words, const std::string& out,
                                const std::string& err) {
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  dup2(open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDOUT_FILENO);
  dup2(open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
  execv(argv[0], argv.data());
  _exit(127);
}

ProgramResult RunProgram(const std::vector<std::string>& words,
                         const std::function<bool()>& interrupt_when, int signal) {
  constexpr useconds_t kPoll_us = 5000;
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const std::string err = folder / "err";
  const pid_t child = fork();
  if (child == 0) BecomeProgram(words, out, err);
  int status = 0;
  bool interrupted = interrupt_when == nullptr;
  while (waitpid(child, &status, interrupted ? 0 : WNOHANG) == 0) {
    if (interrupt_when()) {
      kill(child, signal);
      interrupted = true;
    }
    usleep(kPoll_us);
  }
  return {WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status), ReadFile(out),
          ReadFile(err)};
}

}  // namespace

ProgramResult RunDuet(const std::vector<std::string>& arguments,
                      const std::function<bool()>& interrupt_when, int signal) {
  std::vector<std::string> words = {DUET_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return RunProgram(words, interrupt_when, signal);
}

ProgramResult RunShell(const std::string& command) {
  return RunProgram({"/bin/sh", "-c", "export DUET='" DUET_PROGRAM "'\n" + command}, nullptr, 0);
}

bool IsInstalled(const std::string& program) {
  return RunShell("command -v " + program).status == 0;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = fs::temp_directory_path() / "duet-acceptance-XXXXXX";
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string ReadFile(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

void WriteFile(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::vector<std::string> FilesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename());
  }
  std::sort(names.begin(), names.end());
  return names;
}

fs::path RealData() {
  const char* told = std::getenv("DUET_DATA");
  const fs::path folder =
      told != nullptr ? fs::path(told) : fs::path(DUET_SOURCE) / "../shared/data";
  return fs::exists(folder / "euroc") ? folder : fs::path();
}

}  // namespace duet
