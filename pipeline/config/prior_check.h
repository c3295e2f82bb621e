/// Rules between a marginal of the prior and the simulator's parameter.
#pragma once

#include <cstddef>

#include "inference/prior.h"
#include "pipeline/config/problems.h"
#include "sim/parameter.h"

namespace npdr::pipeline {

/// Parameters that a prior may have.
inline constexpr std::size_t kMostParameters = 1000;

/// Adds to `reading` what is wrong with the two numbers of `marginal`: bounds must be inside of
/// what is physically possible, and a normal must have at most 1e-3 of its mass outside of it,
/// because simulations of impossible parameters fail.
void check_bounds(const inference::Marginal& marginal, const sim::Parameter& parameter,
                  Reading& reading);

}  // namespace npdr::pipeline
