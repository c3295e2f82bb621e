/// Draws of a posterior, weighted as draws of another one.
#pragma once

#include "core/types.h"

namespace npdr::pipeline {

/// Weights w_i L_i^power (n), over a constant, of draws with the weights w (n): those of the
/// posterior whose likelihood has one more factor L^power, L by its logs [nats] (n). Cut off at
/// their mean times sqrt(n) (Ionides 2008, "Truncated importance sampling"); 0 where log L isn't
/// finite.
Vector weights_at_power(const Vector& weights, const Vector& log_likelihood, double power);

}  // namespace npdr::pipeline
