// The kernel of matrix products, compiled once for all libraries and programs.

#define DUET_EIGEN_KERNEL
#include "common/support/eigen_products.h"
