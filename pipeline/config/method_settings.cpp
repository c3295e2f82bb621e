#include "pipeline/config/method_settings.h"

#include <algorithm>

#include "inference/algorithms/pool_powers.h"
#include "pipeline/config/field_use.h"

namespace npdr::pipeline {

bool reads_setting(inference::Algorithm algorithm, const std::string& key) {
  MethodConfig method;
  method.algorithm.kind = algorithm;
  PolicyConfig any;
  any.search.kind = inference::PolicyOptimizerKind::power;
  return std::ranges::count(unused_fields(method, any, ""), key, &UnusedField::path) == 0;
}

Index num_learned_from(const MethodConfig& method) {
  const Index count = method.algorithm.num_simulations;
  const bool is_pooled = method.algorithm.kind == inference::Algorithm::npe_nle;
  return is_pooled ? count - inference::num_judging_rows(count) : count;
}

}  // namespace npdr::pipeline
