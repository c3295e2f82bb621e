/// All weights of a network live in one flat vector, so that the optimizer, the gradient norm and a
/// checkpoint see one array. Layers hold the place of their matrices in it.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Place of one row-major matrix in the flat vector.
struct Block {
  Index offset = 0;
  Index rows = 0;
  Index cols = 0;
};

/// Hands out blocks, each aligned to a cache line. The gaps between them stay zero.
class ParameterLayout {
 public:
  Block add(Index rows, Index cols) {
    const Block block{size_, rows, cols};
    constexpr Index line = 16;  // floats in 64 bytes
    size_ += (rows * cols + line - 1) / line * line;
    return block;
  }
  Index size() const { return size_; }

 private:
  Index size_ = 0;
};

/// Flat storage of parameters, gradients or moments.
template <typename S>
using Parameters = VectorX<S>;

template <typename S>
Eigen::Map<RowMatrixX<S>> view(Parameters<S>& all, const Block& b) {
  return {all.data() + b.offset, b.rows, b.cols};
}

template <typename S>
Eigen::Map<const RowMatrixX<S>> view(const Parameters<S>& all, const Block& b) {
  return {all.data() + b.offset, b.rows, b.cols};
}

}  // namespace npdr::inference
