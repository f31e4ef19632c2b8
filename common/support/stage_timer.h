#pragma once

#include <string>
#include <vector>

namespace duet {

/// CPU time of the calling thread so far [ms].
[[nodiscard]] double ThreadCpuMs();

/// Thread CPU time by named stage, one row a frame; handed into estimators by the caller, who reads
/// it. Nothing an estimator computes depends on it.
class StageTimer {
 public:
  /// Names must be string literals (kept as pointers).
  class Scope {
   public:
    Scope(StageTimer* timer, const char* stage);
    ~Scope();
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    StageTimer* timer_;
    const char* stage_;
    double start_ms_;
  };

  struct Stage {
    const char* name;
    double cpu_ms;
  };

  /// Empties the row; stage names keep their places.
  void StartFrame();
  /// Stages in the order of their first use; times add up within a frame.
  [[nodiscard]] const std::vector<Stage>& stages() const { return stages_; }

 private:
  void Add(const char* stage, double cpu_ms);
  std::vector<Stage> stages_;
};

}  // namespace duet
