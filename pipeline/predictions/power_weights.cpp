#include "pipeline/predictions/power_weights.h"

#include <cmath>

namespace npdr::pipeline {

Vector weights_at_power(const Vector& weights, const Vector& log_likelihood, double power) {
  Vector logs = weights.array().log() + power * log_likelihood.array();
  for (Index i = 0; i < logs.size(); ++i) {
    if (!std::isfinite(log_likelihood(i))) logs(i) = -HUGE_VAL;
  }
  const Vector found = (logs.array() - logs.maxCoeff()).exp();
  return found.cwiseMin(found.sum() / std::sqrt(static_cast<double>(logs.size())));
}

}  // namespace npdr::pipeline
