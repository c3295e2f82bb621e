/// All weights of a network live in one flat vector, so that the optimizer, the gradient norm and a
/// checkpoint see one array. Layers hold the place of their matrices in it; their names tell files
/// and people what is what.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// Place of one row-major matrix in the flat vector.
struct Block {
  Index offset = 0;
  Index rows = 0;
  Index cols = 0;
};

/// A number of rows or columns, and how documents call it.
struct Size {
  Index value = 0;
  const char* name = "";
};

/// A named matrix of weights; one without a name for its number of rows, which is 1, is a vector.
struct Layer {
  std::string name;  ///< "transform_1.output.weight"
  Size rows, cols;
  const char* meaning;
  Block block;
};

/// Whole numbers of the architecture that aren't trained, such as an order of variables.
struct FixedNumbers {
  std::string name;
  Size size;
  const char* meaning;
  std::vector<Index> values;
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
  /// Adds a layer, with its name.
  Block add(const std::string& name, Size rows, Size cols, const char* meaning) {
    layers_.push_back({prefix_ + name, rows, cols, meaning, add(rows.value, cols.value)});
    return layers_.back().block;
  }
  Block add_bias(const std::string& name, Size cols, const char* meaning) {
    return add(name, {1, ""}, cols, meaning);
  }
  void note(const std::string& name, Size size, const char* meaning, std::vector<Index> values) {
    fixed_.push_back({prefix_ + name, size, meaning, std::move(values)});
  }
  /// Prefix of the names of all layers that are added from now on.
  void begin_names_with(std::string prefix) { prefix_ = std::move(prefix); }

  Index size() const { return size_; }
  const std::vector<Layer>& layers() const { return layers_; }
  const std::vector<FixedNumbers>& fixed_numbers() const { return fixed_; }

 private:
  Index size_ = 0;
  std::string prefix_;
  std::vector<Layer> layers_;
  std::vector<FixedNumbers> fixed_;
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
