#include "pipeline/config/study_fields.h"

#include "core/text.h"

namespace npdr::pipeline {
namespace {

template <class T>
bool all_distinct(const std::vector<T>& values) {
  return std::set<T>(values.begin(), values.end()).size() == values.size();
}

bool is_algorithm(const std::string& spelling) {
  try {
    inference::canonical_algorithm(spelling);
    return true;
  } catch (const InputError&) {
    return false;
  }
}

Constraint<std::vector<std::string>> distinct_of(const std::vector<std::string>& known) {
  return {"distinct, each one of " + join(known), [known](const auto& names) {
            return all_distinct(names) && std::ranges::all_of(names, [&](const std::string& name) {
                     return std::ranges::find(known, name) != known.end();
                   });
          }};
}

}  // namespace

Constraint<std::string> algorithm_constraint() {
  Constraint<std::string> constraint = one_of(inference::algorithm_names());
  constraint.allows = is_algorithm;
  return constraint;
}

Constraint<std::string> simulator_constraint() {
  Constraint<std::string> constraint = one_of(sim::simulator_names());
  constraint.allows = [names = constraint.allows](const std::string& value) {
    return value.empty() || names(value);
  };
  return constraint;
}

Constraint<std::string> estimator_constraint() {
  Constraint<std::string> constraint = one_of(inference::estimator_names());
  constraint.allows = [names = constraint.allows](const std::string& value) {
    return value == "mog" || names(value);
  };
  return constraint;
}

Constraint<double> quantile_constraint() {
  return {"> 0 and <= 1", [](double v) { return v > 0.0 && v <= 1.0; }};
}

Constraint<double> window_constraint() {
  return {"odd, >= 5 and <= 1001",
          [](double v) { return v >= 5.0 && v <= 1001.0 && static_cast<Index>(v) % 2 == 1; }};
}

Constraint<std::vector<std::uint64_t>> seeds_constraint() {
  return {"distinct and >= 0, at least one of them",
          [](const auto& seeds) { return !seeds.empty() && all_distinct(seeds); }};
}

Constraint<std::vector<std::string>> metrics_constraint() {
  Constraint<std::vector<std::string>> constraint = distinct_of(metric_names());
  constraint.words += ", at least one of them";
  constraint.allows = [allows = constraint.allows](const auto& metrics) {
    return !metrics.empty() && allows(metrics);
  };
  return constraint;
}

Constraint<std::vector<std::string>> checks_constraint() { return distinct_of(check_names()); }

Constraint<std::vector<inference::Marginal>> prior_constraint() {
  return {"of at least one parameter", [](const auto& prior) { return !prior.empty(); }};
}

}  // namespace npdr::pipeline
