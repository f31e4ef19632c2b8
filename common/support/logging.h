#pragma once

// The one include of glog: a later Ceres brings absl's macros of the same names, and then this is
// the place to choose.
#include <glog/logging.h>
