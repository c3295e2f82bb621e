/// Where the floor is searched for.
#pragma once

#include <vector>

#include "inference/prior.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Bounds of each parameter of a prior, (D) both.
struct SearchBox {
  Vector lower;
  Vector upper;
};

/// The prior's bounds, or four deviations around the median where it has none, inside of what is
/// physically possible for the simulator.
SearchBox search_box(const std::vector<inference::Marginal>& prior, const sim::SimulatorInfo& info);

}  // namespace npdr::pipeline
