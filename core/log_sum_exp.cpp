#include "core/log_sum_exp.h"

#include <cmath>

#include "core/constants.h"

namespace npdr {
namespace {

template <typename Values>
typename Values::Scalar log_of_sum(const Values& values) {
  const auto largest = values.maxCoeff();
  if (!std::isfinite(largest)) return largest;
  return largest + std::log((values.array() - largest).exp().sum());
}

}  // namespace

double log_sum_exp(const Eigen::Ref<const Vector>& values) { return log_of_sum(values); }
float log_sum_exp(const Eigen::Ref<const VectorF>& values) { return log_of_sum(values); }

double log_mean_exp(const Eigen::Ref<const Vector>& values) {
  return log_sum_exp(values) - std::log(static_cast<double>(values.size()));
}

Vector log_sum_exp_of_terms(std::span<const Vector> terms) {
  Vector largest = terms.front();
  for (const Vector& term : terms) largest = largest.cwiseMax(term);
  Vector sum = Vector::Zero(largest.size());
  for (const Vector& term : terms) {
    sum.array() += (largest.array() > -kInfinity).select((term - largest).array().exp(), 0.0);
  }
  return largest.array() + sum.array().log();
}

}  // namespace npdr
