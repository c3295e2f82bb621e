#include "pipeline/predictions/power_weights.h"

#include "inference/weighted_population.h"

namespace npdr::pipeline {

Vector weights_at_power(const Vector& weights, const Vector& log_likelihood, double power) {
  return inference::truncated(weights.array().log() + power * log_likelihood.array());
}

}  // namespace npdr::pipeline
