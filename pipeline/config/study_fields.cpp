#include "pipeline/config/study_fields.h"

#include <fmt/format.h>

#include <algorithm>

namespace npdr::pipeline {

std::string marginal_words() {
  return "{ uniform = [low, high] }, { log_uniform = [low, high] }, { normal = [mean, std] } or "
         "{ log_normal = [mean of log, std of log] }, of finite numbers";
}

Constraint<std::string> simulator_constraint() {
  Constraint<std::string> constraint = one_of(sim::simulator_names());
  constraint.allows = [names = constraint.allows](const std::string& value) {
    return value.empty() || names(value);
  };
  return constraint;
}

FieldUse use_of_built_in(const sim::SimulatorConfig& simulator, const SourceTraits& source,
                         const std::string& key) {
  if (!source.is_built_in) {
    return {.unused = unless(false, fmt::format("it means nothing to a {}", source.name))};
  }
  const auto names = sim::simulator_names();
  if (std::ranges::count(names, simulator.name) == 0) return {};
  const auto unused = sim::unused_settings(simulator.name);
  return {.unused = unless(std::ranges::count(unused, key) == 0,
                           fmt::format("it means nothing to the simulator '{}'", simulator.name))};
}

FieldUse use_of_algorithm(inference::Algorithm algorithm, bool reads, Affects affects) {
  const std::string why = fmt::format("it means nothing to the algorithm '{}'", name_of(algorithm));
  return {.affects = affects, .unused = unless(reads, why), .settable = true};
}

FieldUse use_of_iterations(const MethodConfig& method, const PolicyConfig& policy, bool reads) {
  if (policy.is_used()) return use_of_algorithm(method.algorithm.kind, reads, Affects::elsewhere);
  return {.affects = Affects::elsewhere, .unused = " without a table [policy]", .omitted = true};
}

}  // namespace npdr::pipeline
