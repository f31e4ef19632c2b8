#include "test/backends/agreement/yaw_uncertainty.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

namespace duet::test {
namespace {

TEST(Yaw, Explore) {
  const double T = std::getenv("T") ? std::atof(std::getenv("T")) : 10.0;
  for (const char* name : {"msckf", "window"})
    for (double s : {1e-4, 0.1, 1.0})
      for (bool fe : {true, false}) {
        const YawUncertainty y = MeasureYaw(name, fe, s, T);
        std::printf("%s fe %d sigma %g: frames %d rest %d lost %d smallest-1 %.3e end %.6f %s\n",
                    name, fe, s, y.frames, y.at_rest, y.lost, y.smallest - 1.0, y.at_end,
                    y.failure.c_str());
        std::fflush(stdout);
      }
}

}  // namespace
}  // namespace duet::test
