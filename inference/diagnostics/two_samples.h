/// Common parts of the tests of two samples.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// Fewer rows of a sample than this say nothing.
inline constexpr Index kFewestRowsOfSample = 10;

/// Throws ShapeError unless both samples have the same columns, and InputError for fewer than
/// kFewestRowsOfSample rows or what isn't finite; `test` begins the message.
void require_two_samples(const std::string& test, const RowMatrix& first, const RowMatrix& second);

/// Both samples, one below the other.
RowMatrix pooled(const RowMatrix& first, const RowMatrix& second);

/// Mean and deviation (n - 1 in the denominator) of a column.
struct ColumnMoments {
  double mean = 0.0;
  double deviation = 0.0;
};

/// Those of the columns (D) of x (n, D), n >= 2; squares neither over- nor underflow.
std::vector<ColumnMoments> column_moments(const RowMatrix& x);

/// How many rows of x (n, D) are copies of others: n less the number of different ones.
Index num_repeated_rows(const RowMatrix& x);

/// (x - mean) / deviation, column by column, with mean and deviation of
/// `reference`; a column that doesn't vary there is only shifted. Clamped to +-10^6, far enough for
/// any test to tell it apart, and near enough for single precision.
RowMatrixF standardized(const RowMatrix& x, const RowMatrix& reference);

}  // namespace npdr::inference
