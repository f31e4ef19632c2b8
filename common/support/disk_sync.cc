#include "common/support/disk_sync.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "common/support/input_error.h"

namespace duet {
namespace fs = std::filesystem;

namespace {

/// Of a file system that does not sync, or not folders, and of a folder that we may write to and
/// not read: nothing that trying again, or another disk, would help.
bool CannotSync(int error) {
  return error == EINVAL || error == ENOTSUP || error == ENOSYS || error == EROFS ||
         error == EACCES;
}

[[noreturn]] void FailSync(const fs::path& path, int error) {
  throw OutputError(path.string(), std::string("cannot be written to disk: ") + strerror(error));
}

/// False where `sync` can't be had for the path. Throws OutputError.
bool TrySync(const fs::path& path, int (*sync)(int descriptor)) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  int error = descriptor < 0 ? errno : 0;
  if (descriptor >= 0) {
    do {
      error = sync(descriptor) == 0 ? 0 : errno;
    } while (error == EINTR);
    close(descriptor);
  }
  if (error != 0 && !CannotSync(error)) FailSync(path, error);
  return error == 0;
}

}  // namespace

const SyncCalls& DiskSync() {
#ifdef __linux__
  static constexpr SyncCalls calls = {fsync, syncfs};
#else
  static constexpr SyncCalls calls = {fsync, nullptr};
#endif
  return calls;
}

void SyncPath(const fs::path& path, const SyncCalls& calls) { (void)TrySync(path, calls.file); }

void SyncTree(const fs::path& folder, const SyncCalls& calls) {
  // A record has a dozen files, and every fsync waits for the disk once more: with all of them a
  // run's commit takes several times as long.
  if (calls.file_system != nullptr && TrySync(folder, calls.file_system)) return;
  std::vector<fs::path> files;
  std::vector<fs::path> folders = {folder};
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const fs::file_status status = entry->symlink_status(error);
    if (error) break;
    if (fs::is_regular_file(status)) files.push_back(entry->path());
    if (fs::is_directory(status)) folders.push_back(entry->path());
  }
  if (error) throw OutputError(folder.string(), "cannot be read: " + error.message());
  for (const fs::path& file : files) SyncPath(file, calls);
  // A folder was found before those in it.
  for (auto each = folders.rbegin(); each != folders.rend(); ++each) SyncPath(*each, calls);
}

}  // namespace duet
