#pragma once

#include <algorithm>
#include <vector>

#include "test/acceptance/program.h"

/// Skips a test, loudly, on a machine without the recording.
#define SKIP_WITHOUT(folder)                                                        \
  if (RealData().empty() || !std::filesystem::exists(RealData() / (folder))) {      \
    GTEST_SKIP() << "SKIPPED: no recording " << (folder)                            \
                 << " on this machine (set DUET_DATA to the folder of recordings)"; \
  }

namespace duet {

/// The upper of the middle two where their number is even.
[[nodiscard]] inline double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace duet
