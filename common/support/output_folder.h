#pragma once

#include <filesystem>

namespace duet {

/// An output folder that is complete or absent (DESIGN.md section 4): everything is written into a
/// sibling `TARGET.partial-<pid>`, which Commit() renames to the target. Without Commit() the
/// destructor removes it.
class OutputFolder {
 public:
  /// Makes the temporary folder, and the target's parents where they are missing. Throws
  /// OutputError where the target exists or cannot be made.
  explicit OutputFolder(const std::filesystem::path& target);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until Commit().
  [[nodiscard]] const std::filesystem::path& path() const { return partial_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Puts the folder into its place; once. Throws OutputError where something has come there
  /// meanwhile.
  void Commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path partial_;
  bool committed_ = false;
};

}  // namespace duet
