/// Do the simulations that failed have other parameters than those that didn't?
///
/// Rows that failed are left out, and with them what they would have said of their parameters:
/// where P(failed | theta) isn't the same everywhere, the posterior is that of theta and of not
/// having failed. Tested by permutations: which rows failed is dealt out at random, which is exact
/// for any number of rows when failures don't depend on theta. The statistic is the largest
/// difference |mean of the failed - mean of all|, over all u_d, all u_d^2 and all products u_d u_e,
/// each standardized over all rows: with the largest of the permuted ones it is compared as a
/// whole, so many parameters raise no false alarms (Westfall and Young 1993, "Resampling-based
/// multiple testing", the maximum statistic).
#pragma once

#include <utility>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// The largest difference, and how improbable it is.
struct FailureDependence {
  Index num_failed = 0;
  Index num_good = 0;
  /// Numbers of the two parameters whose product it is; {d, d}: a square, {d, -1}: u_d itself,
  /// which is said before the others where it differs half as much.
  std::pair<Index, Index> term = {0, -1};
  /// Mean of the failed rows minus that of the good ones, in deviations of all.
  double shift = 0.0;
  double p_value =
      1.0;  ///< tail_probability.h, of 1000 permutations; 1 without failed or good rows
};

/// Settings of the test.
struct FailureDependenceConfig {
  Index num_permutations = 1000;
  Index most_rows = 5000;      ///< of each kind, drawn at random; more say little more
  Index most_parameters = 50;  ///< beyond, products aren't looked at
};

/// Tests rows of u (n, D) where the prior is N(0, I), draws of one distribution; `failed` (n). The
/// bits don't depend on the number of threads. Throws ShapeError when shapes don't go together.
FailureDependence test_failures(const RowMatrix& u, const std::vector<bool>& failed,
                                const StreamId& id, const FailureDependenceConfig& config = {});

}  // namespace npdr::inference
