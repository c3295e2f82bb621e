#include "inference/ensemble.h"

#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"

namespace npdr::inference {

std::uint64_t seed_of_network(std::uint64_t seed, Index m) {
  if (m == 0) return seed;
  Stream stream({seed, "network_of_ensemble", 0, static_cast<std::uint64_t>(m), 0});
  const std::uint64_t high = stream.bits();
  return high << 32 | stream.bits();
}

NetworkParts network_of(const NetworkParts& parts, Index m) {
  const Index size = parts.parameters.size() / parts.estimator.num_networks;
  NetworkParts one{.prior = parts.prior,
                   .of_role = parts.of_role,
                   .estimator = parts.estimator,
                   .structure_seed = seed_of_network(parts.structure_seed, m),
                   .transform = parts.transform,
                   .parameters = parts.parameters.segment(m * size, size),
                   .x_o = parts.x_o};
  if (auto* const direct = std::get_if<DirectParts>(&one.of_role)) direct->likelihood.reset();
  one.estimator.num_networks = 1;
  return one;
}

Parameters<float> joined(const std::vector<Parameters<float>>& weights) {
  const Index size = weights.front().size();
  Parameters<float> all(size * std::ssize(weights));
  for (Index m = 0; m < std::ssize(weights); ++m) {
    all.segment(m * size, size) = weights[static_cast<std::size_t>(m)];
  }
  return all;
}

void require_weights(const NetworkParts& parts, Index num_parameters) {
  const Index expected = parts.estimator.num_networks * num_parameters;
  if (parts.parameters.size() == expected && parts.x_o.size() == parts.transform.num_inputs()) {
    return;
  }
  throw ShapeError("posterior: " + std::to_string(parts.parameters.size()) + " weights and " +
                   std::to_string(parts.x_o.size()) + " features, must be " +
                   std::to_string(expected) + " and " +
                   std::to_string(parts.transform.num_inputs()));
}

void LogMeanExp::add(const VectorF& values) {
  if (count_++ == 0) {
    log_sum_ = values;
    return;
  }
  const auto is_nan = log_sum_.array().isNaN() || values.array().isNaN();
  const auto larger = log_sum_.array().max(values.array());
  const auto smaller = log_sum_.array().min(values.array());
  const VectorF sum =
      (larger == smaller)
          .select(larger + std::log(2.0f), larger + (smaller - larger).exp().log1p());
  log_sum_ = is_nan.select(kFloatNaN, sum.array()).eval();
}

VectorF LogMeanExp::result() const {
  return log_sum_.array() - std::log(static_cast<float>(count_));
}

}  // namespace npdr::inference
