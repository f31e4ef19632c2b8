#include "experiments/study/study_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

#include "common/support/input_error.h"
#include "experiments/interrupt.h"

namespace duet {
namespace {

constexpr useconds_t kLockPoll_us = 5000;

int OpenLock(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    throw OutputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
  }
  return descriptor;
}

/// A file system without locks has nobody to wait for.
bool IsHeldElsewhere() { return errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

std::optional<StudyLock> StudyLock::Try(const std::filesystem::path& file, Kind kind) {
  StudyLock lock(OpenLock(file));
  const int operation = (kind == Kind::kExclusive ? LOCK_EX : LOCK_SH) | LOCK_NB;
  if (flock(lock.descriptor_, operation) != 0 && IsHeldElsewhere()) return std::nullopt;
  return lock;
}

std::optional<StudyLock> StudyLock::Wait(const std::filesystem::path& file) {
  while (!Interrupted()) {
    if (std::optional<StudyLock> lock = Try(file, Kind::kExclusive)) return lock;
    usleep(kLockPoll_us);
  }
  return std::nullopt;
}

StudyLock::StudyLock(StudyLock&& other) noexcept : descriptor_(other.descriptor_) {
  other.descriptor_ = -1;
}

StudyLock::~StudyLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace duet
