/// Numbers that stand for a failure, such as -999, where rows should hold NaN.
#pragma once

#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// Looks over the rows of x, as many at once as there are, for columns that hold their smallest or
/// largest number several times, further from all others than these lie apart. What isn't finite
/// doesn't count. Keeps a few numbers a column.
class RepeatedOutliers {
 public:
  explicit RepeatedOutliers(Index num_columns);

  /// More rows (n, F). Throws ShapeError for another number of columns.
  void observe(const Eigen::Ref<const RowMatrixF>& x);

  /// Which of the columns, whose names these are. Throws ShapeError for another number of names.
  Findings find(const std::vector<Channel>& columns) const;

 private:
  // One end of a column's numbers, in the order of `sign` times them.
  struct End {
    float sign = 1.0f;
    float outermost = 0.0f, next = 0.0f;
    Index num_outermost = 0, num_others = 0;

    void observe(float value);
    bool is_outlier(float innermost) const;
  };
  struct Ends {
    End smallest{.sign = 1.0f}, largest{.sign = -1.0f};
  };

  std::vector<Ends> columns_;
  Index num_rows_ = 0;
};

}  // namespace npdr::pipeline
