// Packing, matrix-vector products and triangular solves, compiled once for all libraries and
// programs.

#define DUET_EIGEN_PRODUCTS
#include "common/support/eigen_products.h"
