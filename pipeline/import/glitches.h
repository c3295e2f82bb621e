/// Samples that a sensor got wrong: single ones far beyond all others.
#pragma once

#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

/// Samples t of a recorded channel (n) that lie further than twice the range of its usual values,
/// those between their 1 % and 99 % quantiles, from the mean of their neighbours, which lie within
/// a quarter of that distance of each other. Steps, impacts and short contacts have none.
/// Ascending; empty for fewer than 10 samples, and where the usual values are all the same.
std::vector<Index> find_glitches(const Vector& values);

}  // namespace npdr::pipeline
