/// Array types that cross module borders. Batches are row-major, one sample a row; loops that are
/// the same for every sample take them column-major.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/eigen_kernels.h"

namespace npdr {

template <typename Scalar>
using RowMatrixX = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
template <typename Scalar>
using ColumnMatrixX = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor>;
template <typename Scalar>
using VectorX = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

using RowMatrix = RowMatrixX<double>;
using RowMatrixF = RowMatrixX<float>;
using Vector = VectorX<double>;
using VectorF = VectorX<float>;
using Index = Eigen::Index;

}  // namespace npdr
