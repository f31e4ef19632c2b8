#include "common/support/stage_timer.h"

#include <time.h>

#include <cstring>

namespace duet {

double ThreadCpuMs() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

StageTimer::Scope::Scope(StageTimer* timer, const char* stage)
    : timer_(timer), stage_(stage), start_ms_(timer == nullptr ? 0.0 : ThreadCpuMs()) {}

StageTimer::Scope::~Scope() {
  if (timer_ != nullptr) timer_->Add(stage_, ThreadCpuMs() - start_ms_);
}

void StageTimer::StartFrame() {
  for (Stage& stage : stages_) stage.cpu_ms = 0.0;
}

void StageTimer::Add(const char* stage, double cpu_ms) {
  for (Stage& known : stages_) {
    if (std::strcmp(known.name, stage) == 0) {
      known.cpu_ms += cpu_ms;
      return;
    }
  }
  stages_.push_back({stage, cpu_ms});
}

}  // namespace duet
