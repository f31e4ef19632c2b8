#pragma once

#include <filesystem>
#include <optional>

namespace duet {

/// A lock (flock) on a file, held while the object lives and let go by the system where its process
/// dies. On a folder shared between machines it may lock nothing: results must not depend on it.
class StudyLock {
 public:
  enum class Kind { kShared, kExclusive };

  /// Nothing where another process holds it. Throws OutputError where there can be no such file.
  [[nodiscard]] static std::optional<StudyLock> Try(const std::filesystem::path& file, Kind kind);
  /// Waits for it; nothing where the program was interrupted meanwhile.
  [[nodiscard]] static std::optional<StudyLock> Wait(const std::filesystem::path& file);

  StudyLock(StudyLock&& other) noexcept;
  StudyLock& operator=(StudyLock&&) = delete;
  ~StudyLock();

 private:
  explicit StudyLock(int descriptor) : descriptor_(descriptor) {}
  int descriptor_ = -1;
};

}  // namespace duet
