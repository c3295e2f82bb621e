/// Arrays whose values say where they belong.
#pragma once

#include <numeric>

#include "core/types.h"

namespace npdr::pipeline {

/// 0, 1, 2, ... row by row.
inline RowMatrix counted(Index rows, Index cols) {
  RowMatrix values(rows, cols);
  std::iota(values.data(), values.data() + values.size(), 0.0);
  return values;
}

}  // namespace npdr::pipeline
