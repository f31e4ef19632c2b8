#pragma once

#include <filesystem>

#include "common/support/disk_sync.h"

namespace duet {

/// An output folder that is complete or absent (DESIGN.md section 4): everything is written into a
/// sibling `TARGET.partial-<host>-<pid>`, which Commit() renames to the target when all of it is on
/// the disk, so that a power cut leaves no torn one either. Without Commit() the destructor removes
/// it.
class OutputFolder {
 public:
  enum class Makers {
    kOne,
    kSeveral,  ///< others may be making the same target, on other machines too: CommitUnlessThere
  };

  /// Makes the temporary folder, and the target's parents where they are missing. Throws
  /// OutputError where the target cannot be made or, with one maker, exists.
  /// `sync`: what waits for the disk.
  explicit OutputFolder(const std::filesystem::path& target, Makers makers = Makers::kOne,
                        const SyncCalls& sync = DiskSync());
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until Commit().
  [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Puts the folder into its place; once. Throws OutputError where something has come there
  /// meanwhile, and where the disk can't hold what was written.
  void Commit();

  /// The same with several makers: false where another one was first; its folder stays, this one is
  /// removed.
  [[nodiscard]] bool CommitUnlessThere();

 private:
  void SyncPlace() const;

  std::filesystem::path target_;
  std::filesystem::path partial_;
  SyncCalls sync_;
  bool committed_ = false;
};

/// The partial folders in `folder` that processes of this machine have left which are no more.
/// Those of other machines, and of processes that run, are left alone.
void RemoveAbandonedPartials(const std::filesystem::path& folder);

}  // namespace duet
