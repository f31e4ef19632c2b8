#pragma once

// Eigen's kernels for products and triangular solves of dynamic matrices of doubles, compiled once
// (eigen_kernel.cc, eigen_products.cc) instead of in every object that multiplies two matrices: an
// eighth of the object code of a filter. Part of the precompiled header; without it every source
// makes its own, as usual.
//
// The names are internal to Eigen 3.4; with any other version this header says nothing.

#include <Eigen/Core>

#if EIGEN_VERSION_AT_LEAST(3, 4, 0) && !EIGEN_VERSION_AT_LEAST(3, 4, 90)
#ifndef DUET_EIGEN_KERNEL
#define DUET_EIGEN_KERNEL extern
#endif
#ifndef DUET_EIGEN_PRODUCTS
#define DUET_EIGEN_PRODUCTS extern
#endif

namespace Eigen::internal {

using DuetTraits = gebp_traits<double, double>;
template <int order>
using DuetConstMapper = const_blas_data_mapper<double, Index, order>;
using DuetMapper = blas_data_mapper<double, Index, ColMajor, Unaligned, 1>;

// Packed panels times packed panels, the inner loops of them all.
DUET_EIGEN_KERNEL template struct gebp_kernel<double, double, Index, DuetMapper, DuetTraits::mr,
                                              DuetTraits::nr, false, false>;

// The copies into packed panels: of the left and the right factor, and those of triangular solves.
#define DUET_PACK_LHS(mapper, order, panel)                           \
  DUET_EIGEN_PRODUCTS template struct gemm_pack_lhs<                  \
      double, Index, mapper, DuetTraits::mr, DuetTraits::LhsProgress, \
      DuetTraits::LhsPacket4Packing, order, false, panel>
#define DUET_PACK_RHS(mapper, order, panel)                                                       \
  DUET_EIGEN_PRODUCTS template struct gemm_pack_rhs<double, Index, mapper, DuetTraits::nr, order, \
                                                    false, panel>
DUET_PACK_LHS(DuetConstMapper<ColMajor>, ColMajor, false);
DUET_PACK_LHS(DuetConstMapper<RowMajor>, RowMajor, false);
DUET_PACK_LHS(DuetMapper, ColMajor, true);
DUET_PACK_RHS(DuetConstMapper<ColMajor>, ColMajor, false);
DUET_PACK_RHS(DuetConstMapper<RowMajor>, RowMajor, false);
DUET_PACK_RHS(DuetMapper, ColMajor, true);
#undef DUET_PACK_LHS
#undef DUET_PACK_RHS

// Matrix times vector: either order of the matrix, either of the mapper of the vector.
#define DUET_MATRIX_VECTOR(matrix_order, vector_order)                           \
  DUET_EIGEN_PRODUCTS template struct general_matrix_vector_product<             \
      Index, double, DuetConstMapper<matrix_order>, matrix_order, false, double, \
      DuetConstMapper<vector_order>, false, Specialized>
DUET_MATRIX_VECTOR(ColMajor, ColMajor);
DUET_MATRIX_VECTOR(ColMajor, RowMajor);
DUET_MATRIX_VECTOR(RowMajor, ColMajor);
DUET_MATRIX_VECTOR(RowMajor, RowMajor);
#undef DUET_MATRIX_VECTOR

// L X = B, unit L X = B, U X = B of LLT, LU and QR; X U = B of blocked LLT.
DUET_EIGEN_PRODUCTS template struct triangular_solve_matrix<double, Index, OnTheLeft, Lower, false,
                                                            ColMajor, ColMajor, 1>;
DUET_EIGEN_PRODUCTS template struct triangular_solve_matrix<double, Index, OnTheLeft, UnitLower,
                                                            false, ColMajor, ColMajor, 1>;
DUET_EIGEN_PRODUCTS template struct triangular_solve_matrix<double, Index, OnTheLeft, Upper, false,
                                                            ColMajor, ColMajor, 1>;
DUET_EIGEN_PRODUCTS template struct triangular_solve_matrix<double, Index, OnTheRight, Upper, false,
                                                            RowMajor, ColMajor, 1>;

DUET_EIGEN_PRODUCTS template void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(
    Index& k, Index& m, Index& n, Index num_threads);
DUET_EIGEN_PRODUCTS template void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(
    Index& k, Index& m, Index& n, Index num_threads);

}  // namespace Eigen::internal
#endif
