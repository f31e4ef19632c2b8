#pragma once

#include <filesystem>
#include <string>

namespace duet {

/// Version and commit of the program that wrote a folder with a manifest.json.
struct RecordVersion {
  std::string version;
  std::string commit;

  [[nodiscard]] bool operator==(const RecordVersion&) const = default;
  /// "duet 0.1.0 (commit 2838f4577241)"
  [[nodiscard]] std::string Text() const;
};

[[nodiscard]] RecordVersion OwnVersion();
/// Throws InputError where there is no manifest.
[[nodiscard]] RecordVersion VersionOf(const std::filesystem::path& folder);

/// Refuses what another version of the program has written: results of two are never mixed.
/// Throws InputError that names the folder and both.
void RequireOwnVersion(const std::filesystem::path& folder);

/// The folder, with its parents, where it is not there. Throws OutputError.
void MakeFolder(const std::filesystem::path& folder);

}  // namespace duet
