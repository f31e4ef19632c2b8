#include "experiments/study/record_version.h"

#include <system_error>

#include "common/support/input_error.h"
#include "common/support/text_file.h"
#include "experiments/build_info.h"
#include "experiments/manifest_reader.h"

namespace duet {

std::string RecordVersion::Text() const { return "duet " + version + " (commit " + commit + ")"; }

RecordVersion OwnVersion() { return {GetBuildInfo().version, GetBuildInfo().commit}; }

RecordVersion VersionOf(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "manifest.json";
  const ManifestReader manifest(ReadTextFile(file), file.string());
  return {manifest.Text("version"), manifest.Text("commit")};
}

void RequireOwnVersion(const std::filesystem::path& folder) {
  const RecordVersion version = VersionOf(folder);
  if (version == OwnVersion()) return;
  throw InputError(folder.string(), 0, "",
                   "was made by " + version.Text() + ", this is " + OwnVersion().Text() +
                       "; results of two are not mixed: expected another --out");
}

void MakeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw OutputError(folder.string(), "cannot be made: " + error.message());
}

}  // namespace duet
