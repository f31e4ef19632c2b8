#include "common/support/output_folder.h"

#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <limits>
#include <optional>
#include <string>
#include <system_error>

#include "common/support/input_error.h"
#include "common/support/logging.h"
#include "common/support/numeric_text.h"
#include "common/support/partial_name.h"

namespace duet {
namespace fs = std::filesystem;

namespace {

constexpr const char* kPartial = ".partial-";

std::string HostName() {
  char name[256] = "";
  if (gethostname(name, sizeof name - 1) != 0 || name[0] == '\0') return "host";
  return name;
}

// The process whose partial folder of this machine `name` is; 0 where it is none.
pid_t OwnerOf(const std::string& name) {
  const std::string mark = kPartial + HostName() + "-";
  const std::size_t found = name.rfind(mark);
  if (found == std::string::npos) return 0;
  const std::string rest = name.substr(found + mark.size());
  // A further name of the same process ends in "-<attempt>".
  const std::optional<std::int64_t> pid = ParseInt64(rest.substr(0, rest.find('-')));
  return pid && *pid > 0 && *pid <= std::numeric_limits<pid_t>::max() ? static_cast<pid_t>(*pid)
                                                                      : 0;
}

void RefuseExisting(const fs::path& target) {
  std::error_code error;
  if (fs::exists(fs::symlink_status(target, error))) {
    throw OutputError(target.string(), "exists; name an output folder that does not exist yet");
  }
}

}  // namespace

std::string PartialName(const std::string& target) {
  return target + kPartial + HostName() + "-" + std::to_string(getpid());
}

OutputFolder::OutputFolder(const fs::path& target, Makers makers, const SyncCalls& sync)
    : target_(target), sync_(sync) {
  // "out/" and "out" are the same folder; the sibling's name needs the latter.
  if (!target_.has_filename()) target_ = target_.parent_path();
  if (target_.empty()) throw OutputError("output folder", "has an empty name");
  if (makers == Makers::kOne) RefuseExisting(target_);
  std::error_code error;
  if (target_.has_parent_path()) {
    fs::create_directories(target_.parent_path(), error);
    if (error) {
      throw OutputError(target_.string(), "cannot be made: " + error.message());
    }
  }
  // A crashed process that had the same id may have left its folder: take the next free name.
  const std::string base = PartialName(target_.string());
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
  SyncTree(partial_, sync_);
  std::error_code error;
  fs::rename(partial_, target_, error);
  if (error)
    throw OutputError(target_.string(), "cannot be renamed into place: " + error.message());
  committed_ = true;
  SyncPlace();
}

/// Its name in the folder that it is in.
void OutputFolder::SyncPlace() const {
  SyncPath(target_.has_parent_path() ? target_.parent_path() : ".", sync_);
}

bool OutputFolder::CommitUnlessThere() {
  CHECK(!committed_) << target_ << " is committed already";
  std::error_code error;
  SyncTree(partial_, sync_);
  // A folder with files in it is never replaced by rename().
  fs::rename(partial_, target_, error);
  if (!error) {
    committed_ = true;
    SyncPlace();
    return true;
  }
  if (!fs::exists(target_)) {
    throw OutputError(target_.string(), "cannot be renamed into place: " + error.message());
  }
  fs::remove_all(partial_, error);
  committed_ = true;
  return false;
}

void RemoveAbandonedPartials(const fs::path& folder) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const pid_t owner = OwnerOf(entry.path().filename().string());
    if (owner == 0 || owner == getpid()) continue;
    if (kill(owner, 0) != 0 && errno == ESRCH) fs::remove_all(entry.path(), ignored);
  }
}

}  // namespace duet
