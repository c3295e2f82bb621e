/// Rows of theta and x that tests of rows look at (row_faults.h).
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// The rows of theta (n, D) and x (n, F) whose x is finite. Throws ShapeError where rows aren't as
/// many.
struct FiniteRows {
  FiniteRows(const RowMatrix& all_theta, const RowMatrixF& all_x);

  std::vector<Index> numbers;  ///< among all rows
  RowMatrix theta;
  RowMatrixF x;
};

/// The columns of rows (n, C) that hold more than one value.
template <class Matrix>
std::vector<Index> varying_columns_of(const Matrix& rows) {
  std::vector<Index> varying;
  for (Index c = 0; c < rows.cols(); ++c) {
    if (rows.col(c).maxCoeff() > rows.col(c).minCoeff()) varying.push_back(c);
  }
  return varying;
}

}  // namespace npdr::inference
