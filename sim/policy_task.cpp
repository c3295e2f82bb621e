#include "sim/policy_task.h"

#include <fmt/format.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/text.h"
#include "sim/simulator.h"

namespace npdr::sim {
namespace {

void check_width(const PolicyTaskInfo& info, const RowMatrix& policies) {
  if (policies.cols() == static_cast<Index>(info.parameters.size())) return;
  throw ShapeError(fmt::format("policies of {} parameters, must have {}", policies.cols(),
                               info.parameters.size()));
}

}  // namespace

void PolicyRollouts::resize(Index rows) {
  const auto n = static_cast<std::size_t>(rows);
  returns.setConstant(rows, kNaN);
  num_steps.assign(n, 0);
  success.assign(n, 0);
  status.assign(n, RolloutStatus::ok);
}

Vector initial_policy(const PolicyTaskInfo& info) {
  Vector policy(static_cast<Index>(info.parameters.size()));
  Index q = 0;
  for (const PolicyParameter& parameter : info.parameters) policy(q++) = parameter.initial;
  return policy;
}

RowMatrix to_search_space(const PolicyTaskInfo& info, const RowMatrix& policies) {
  check_width(info, policies);
  RowMatrix points = policies;
  for (Index q = 0; q < points.cols(); ++q) {
    const PolicyParameter& parameter = info.parameters[static_cast<std::size_t>(q)];
    if (!parameter.log_scale) continue;
    for (double& value : points.col(q)) {
      if (!(value > 0.0)) {
        throw InputError(
            fmt::format("policy parameter {} = {}, must be > 0", parameter.name, value));
      }
      value = std::log(value);
    }
  }
  return points;
}

RowMatrix from_search_space(const PolicyTaskInfo& info, const RowMatrix& points) {
  check_width(info, points);
  RowMatrix policies = points;
  for (Index q = 0; q < policies.cols(); ++q) {
    if (!info.parameters[static_cast<std::size_t>(q)].log_scale) continue;
    for (double& value : policies.col(q)) value = std::exp(value);
  }
  return policies;
}

std::unique_ptr<PolicyTask> make_policy_task(const SimulatorConfig& simulator,
                                             const PolicyTaskConfig& config) {
  auto task = make_simulator(simulator)->policy_task(config);
  if (task) return task;
  throw InputError(fmt::format("simulator '{}' has no policy task; those with one: {}",
                               simulator.name, join(simulators_with_policy_task())));
}

std::vector<std::string> simulators_with_policy_task() {
  std::vector<std::string> names;
  for (const std::string& name : simulator_names()) {
    if (make_simulator({.name = name})->policy_task({})) names.push_back(name);
  }
  return names;
}

}  // namespace npdr::sim
