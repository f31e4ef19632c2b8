#pragma once

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace duet {

/// The whole file. Throws InputError where it is missing, a folder or unreadable.
[[nodiscard]] std::string ReadTextFile(const std::filesystem::path& path);

/// Writes a file piece by piece, buffered. Every failure (a full disk too) is an OutputError, at
/// the latest in Close(); a writer that is destroyed without Close() swallows it.
class TextFileWriter {
 public:
  explicit TextFileWriter(const std::filesystem::path& path);
  void Write(std::string_view text);
  void Close();

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::string path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Writes the whole file at once.
void WriteTextFile(const std::filesystem::path& path, std::string_view text);

/// The same for a file that others may read or replace at the same time, from other machines too:
/// at every moment there is the old text or the new one, whole, after a power cut too.
void ReplaceTextFile(const std::filesystem::path& path, std::string_view text);

}  // namespace duet
