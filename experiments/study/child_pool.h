#pragma once

#include <csignal>
#include <functional>
#include <map>
#include <optional>

#include "experiments/child_process.h"

namespace duet {

/// Work in processes of its own, several at once. A child is this process forked, without a start
/// of the program; the process must have no thread but one. A child that crashes takes nothing with
/// it, and none outlives this process.
class ChildPool {
 public:
  ChildPool();
  ChildPool(const ChildPool&) = delete;
  ChildPool& operator=(const ChildPool&) = delete;
  /// Ends and waits for what is still running.
  ~ChildPool();

  /// Starts `work` in a child, on one core where one is named; what it returns is the child's exit
  /// status (exceptions are work's own to catch). `number` names it.
  void Start(int number, std::optional<int> core, const std::function<int()>& work);

  struct Ended {
    int number = 0;
    ChildResult result;
  };
  /// A child that has ended; nothing where none has within `wait_s`. An interruption of the program
  /// is passed on to the children, which end when they have finished their frame.
  [[nodiscard]] std::optional<Ended> Wait(double wait_s);

  [[nodiscard]] int running() const { return static_cast<int>(numbers_.size()); }

 private:
  void PassOnInterruption();

  std::map<int, int> numbers_;  // by process id
  sigset_t mask_before_{};
  bool passed_on_ = false;
};

}  // namespace duet
