#include "common/support/text_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "common/support/disk_sync.h"
#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/partial_name.h"

namespace duet {

std::string ReadTextFile(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) {
    throw InputError(path.string(), 0, "", "no such file");
  }
  if (std::filesystem::is_directory(status)) {
    throw InputError(path.string(), 0, "", "is a folder; expected a file");
  }
  std::unique_ptr<std::FILE, decltype(&std::fclose)> file(std::fopen(path.c_str(), "rb"),
                                                          &std::fclose);
  if (file == nullptr) {
    throw InputError(path.string(), 0, "", std::string("cannot be read: ") + std::strerror(errno));
  }
  std::string text;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error) text.reserve(static_cast<std::size_t>(size));
  char buffer[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(buffer, 1, sizeof(buffer), file.get())) > 0) {
    text.append(buffer, count);
  }
  if (std::ferror(file.get()) != 0) {
    throw InputError(path.string(), 0, "", std::string("cannot be read: ") + std::strerror(errno));
  }
  return text;
}

TextFileWriter::TextFileWriter(const std::filesystem::path& path)
    : path_(path.string()), file_(std::fopen(path.c_str(), "wb")) {
  if (file_ == nullptr) {
    throw OutputError(path_, std::string("cannot be written: ") + std::strerror(errno));
  }
}

void TextFileWriter::Write(std::string_view text) {
  CHECK(file_ != nullptr) << path_ << " is closed";
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) {
    throw OutputError(path_, std::string("cannot be written: ") + std::strerror(errno));
  }
}

void TextFileWriter::Close() {
  CHECK(file_ != nullptr) << path_ << " is closed";
  if (std::fclose(file_.release()) != 0) {
    throw OutputError(path_, std::string("cannot be written: ") + std::strerror(errno));
  }
}

void WriteTextFile(const std::filesystem::path& path, std::string_view text) {
  TextFileWriter writer(path);
  writer.Write(text);
  writer.Close();
}

void ReplaceTextFile(const std::filesystem::path& path, std::string_view text) {
  std::string name = PartialName(path.string()) + "-XXXXXX";
  const int descriptor = mkstemp(name.data());
  if (descriptor < 0) {
    throw OutputError(path.string(), std::string("cannot be written: ") + std::strerror(errno));
  }
  constexpr mode_t kReadable = 0644;
  (void)fchmod(descriptor, kReadable);
  close(descriptor);
  std::error_code error;
  try {
    WriteTextFile(name, text);
    SyncPath(name);
  } catch (const OutputError&) {
    std::filesystem::remove(name, error);
    throw;
  }
  std::filesystem::rename(name, path, error);
  if (!error) {
    SyncPath(path.has_parent_path() ? path.parent_path() : ".");
    return;
  }
  const std::string why = error.message();
  std::filesystem::remove(name, error);
  throw OutputError(path.string(), "cannot be replaced: " + why);
}

}  // namespace duet
