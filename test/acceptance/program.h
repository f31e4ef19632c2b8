#pragma once

#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

/// Skips a test, loudly, on a machine without a program that `packages` of the distribution bring.
#define SKIP_WITHOUT_PROGRAM(program, packages)                        \
  if (!::duet::IsInstalled(program)) {                                 \
    GTEST_SKIP() << "SKIPPED: no " << (program)                        \
                 << " on this machine (apt-get install " packages ")"; \
  }

namespace duet {

/// What a run of the program left behind.
struct ProgramResult {
  int status = -1;  ///< exit status; 128 + N where signal N ended it
  std::string out;
  std::string err;
};

/// Runs the built `duet` with these arguments and waits for it. Where `interrupt_when` is given, it
/// is asked again and again, and when it says yes the program gets `signal`, once.
[[nodiscard]] ProgramResult RunDuet(const std::vector<std::string>& arguments,
                                    const std::function<bool()>& interrupt_when = nullptr,
                                    int signal = SIGINT);
/// The same for a command of the shell, in which "$DUET" is the built program.
[[nodiscard]] ProgramResult RunShell(const std::string& command);

[[nodiscard]] bool IsInstalled(const std::string& program);

/// A folder that goes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

[[nodiscard]] std::string ReadFile(const std::filesystem::path& path);
void WriteFile(const std::filesystem::path& path, const std::string& text);
/// Names in a folder, sorted.
[[nodiscard]] std::vector<std::string> FilesIn(const std::filesystem::path& folder);

/// Root of the real recordings: $DUET_DATA or, beside the repository, ../shared/data; empty where
/// this machine has none.
[[nodiscard]] std::filesystem::path RealData();

}  // namespace duet
