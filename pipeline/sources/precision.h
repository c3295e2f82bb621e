/// A check that rows survive single precision, in which they are kept.
#pragma once

#include <vector>

#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// The columns of x (n, F) that vary by less than 10^-6 of their mean, about ten
/// steps of a float, and more than double precision rounds: what they say is lost to whoever reads
/// them as floats, and feature transforms take them for constants (inference/feature_transform.h).
/// Rows with NaN and infinities don't count, and fewer than eight aren't judged.
Findings find_lost_precision(const RowMatrix& x, const std::vector<Channel>& columns);

}  // namespace npdr::pipeline
