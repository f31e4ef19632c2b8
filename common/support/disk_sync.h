#pragma once

#include <filesystem>

namespace duet {

/// What is renamed into its place when it is complete must be on the disk before, or a power cut
/// may leave the name and not the bytes.

/// What waits for the disk; each as fsync(2): 0, or -1 with errno.
struct SyncCalls {
  int (*file)(int descriptor);  ///< one file, or the names in one folder
  /// All of the file system that the descriptor is on; null where there is no such call.
  int (*file_system)(int descriptor);
};
/// fsync(2), and on Linux syncfs(2).
[[nodiscard]] const SyncCalls& DiskSync();

/// Waits until a file's bytes, or a folder's names, are on the disk. Throws OutputError where they
/// can't be written (the disk is full, or broken); a file system that does not know how to sync is
/// no error.
void SyncPath(const std::filesystem::path& path, const SyncCalls& calls = DiskSync());

/// The same for a folder with all that is in it: by one call for the file system where there is
/// one, else file by file, and each folder after its files.
void SyncTree(const std::filesystem::path& folder, const SyncCalls& calls = DiskSync());

}  // namespace duet
