/// Numbers that stand for a failure, such as -999, where rows should hold NaN.
#pragma once

#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

/// Says which columns of x (n, F), the first rows of a simulation, hold their smallest or largest
/// number several times, further from all others than these lie apart; "": none. What isn't finite
/// doesn't count.
std::string repeated_outliers(const RowMatrix& x, const std::vector<Channel>& columns);

}  // namespace npdr::pipeline
