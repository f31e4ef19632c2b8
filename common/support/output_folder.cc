#include "common/support/output_folder.h"

#include <unistd.h>

#include <string>
#include <system_error>

#include "common/support/input_error.h"
#include "common/support/logging.h"

namespace duet {
namespace fs = std::filesystem;

namespace {

void RefuseExisting(const fs::path& target) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(target, error))) {
    throw OutputError(target.string(), "exists; name an output folder that does not exist yet");
  }
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& target) : target_(target) {
  // "out/" and "out" are the same folder; the sibling's name needs the latter.
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (target_.empty()) throw OutputError("output folder", "has an empty name");
  RefuseExisting(target_);
  std::error_code error;
  if (target_.has_parent_path()) {
    fs::create_directories(target_.parent_path(), error);
    if (error) {
      throw OutputError(target_.string(), "cannot be made: " + error.message());
    }
  }
  // A crashed process that had the same id may have left its folder: take the next free name.
  const std::string base = target_.string() + ".partial-" + std::to_string(getpid());
  for (int attempt = 0; attempt < 100; ++attempt) {
    const fs::path candidate = attempt == 0 ? base : base + "-" + std::to_string(attempt);
    if (fs::create_directory(candidate, error)) {
      partial_ = candidate;
      return;
    }
    if (error) break;
  }
  throw OutputError(target_.string(),
                    "cannot be made: " + (error ? error.message() : "too many partial folders"));
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

void OutputFolder::Commit() {
  CHECK(!committed_) << target_ << " is committed already";
  // rename() would silently replace an empty folder.
  RefuseExisting(target_);
  std::error_code error;
  fs::rename(partial_, target_, error);
  if (error)
    throw OutputError(target_.string(), "cannot be renamed into place: " + error.message());
  committed_ = true;
}

}  // namespace duet
