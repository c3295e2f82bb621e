/// Mean and spread of a metric over samples, some of which failed.
#pragma once

#include "core/types.h"

namespace npdr::analysis {

/// Mean and spread of a metric over samples.
struct Summary {
  double mean = 0.0;   ///< NaN when n = 0
  double std = 0.0;    ///< with n - 1 in the denominator; NaN when n < 2
  Index n = 0;         ///< finite values, over which mean and std are taken
  Index n_failed = 0;  ///< values that aren't finite
};

/// Summary of the finite entries of `values`.
Summary summarize(const Eigen::Ref<const Vector>& values);

/// The same of values of which those a `period` apart are equal: the circular mean
/// (period / 2 pi) arg sum_i exp(2 pi i x_i / period), in the period around `center`, and the
/// deviation of the differences from it, each taken within half a period. period = 0: summarize().
Summary summarize_periodic(const Eigen::Ref<const Vector>& values, double period,
                           double center = 0.0);

}  // namespace npdr::analysis
