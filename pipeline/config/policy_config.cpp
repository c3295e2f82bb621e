#include "pipeline/config/policy_config.h"

namespace npdr::pipeline {

std::vector<double> PolicyGridAxis::points() const {
  if (!values.empty()) return values;
  std::vector<double> points;
  const auto last = static_cast<double>(steps - 1);
  for (Index i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) / last;
    points.push_back((1.0 - t) * range[0] + t * range[1]);
  }
  return points;
}

}  // namespace npdr::pipeline
