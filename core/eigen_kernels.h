/// Kernels of Eigen's products of dynamic matrices, compiled once for all who multiply matrices.
#pragma once

#include <Eigen/Core>

/// Kernels of scalars S: NPDR_EIGEN_KERNELS(extern, S) declares, NPDR_EIGEN_KERNELS(, S) makes
/// them.
#define NPDR_EIGEN_KERNELS(EXTERN, S)                                                             \
  EXTERN template struct gebp_kernel<S, S, Index, blas_data_mapper<S, Index, ColMajor>,           \
                                     gebp_traits<S, S>::mr, gebp_traits<S, S>::nr, false, false>; \
  NPDR_EIGEN_KERNELS_OF_ORDER(EXTERN, S, ColMajor, RowMajor)                                      \
  NPDR_EIGEN_KERNELS_OF_ORDER(EXTERN, S, RowMajor, ColMajor)

#define NPDR_EIGEN_KERNELS_OF_ORDER(EXTERN, S, ORDER, OTHER)                                  \
  EXTERN template struct gemm_pack_lhs<S, Index, const_blas_data_mapper<S, Index, ORDER>,     \
                                       gebp_traits<S, S>::mr, gebp_traits<S, S>::LhsProgress, \
                                       gebp_traits<S, S>::LhsPacket4Packing, ORDER>;          \
  EXTERN template struct gemm_pack_rhs<S, Index, const_blas_data_mapper<S, Index, ORDER>,     \
                                       gebp_traits<S, S>::nr, ORDER>;                         \
  EXTERN template struct general_matrix_vector_product<                                       \
      Index, S, const_blas_data_mapper<S, Index, ORDER>, ORDER, false, S,                     \
      const_blas_data_mapper<S, Index, OTHER>, false>;

namespace Eigen::internal {

NPDR_EIGEN_KERNELS(extern, float)
NPDR_EIGEN_KERNELS(extern, double)

}  // namespace Eigen::internal
