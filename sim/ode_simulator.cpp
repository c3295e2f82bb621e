#include "sim/ode_simulator.h"

#include <algorithm>

#include "core/constants.h"
#include "sim/batch_integrator.h"
#include "sim/ode_policy_task.h"
#include "sim/replay.h"
#include "sim/simulator_check.h"

namespace npdr::sim {
namespace {

void check_config(const SimulatorConfig& config) {
  const bool adaptive = is_adaptive(config.integrator);
  if (config.segment_length < 0) reject_setting("segment_length", config.segment_length, ">= 0");
  if (config.substeps < 1) reject_setting("substeps", config.substeps, ">= 1");
  if (adaptive && config.substeps != 1) {
    reject_setting(
        "substeps", config.substeps,
        "1 with integrator '" + name_of(config.integrator) + "', which picks its own steps");
  }
  if (config.store_every < 1) reject_setting("store_every", config.store_every, ">= 1");
}

}  // namespace

OdeSimulator::OdeSimulator(std::unique_ptr<OdeModel> model, const SimulatorConfig& config)
    : model_(std::move(model)), config_(config), info_(model_->info()) {
  check_config(config_);
  replace_nominal(config_.parameters, info_);
}

Trajectories OdeSimulator::replay(const Target& target, const RowMatrix& theta) const {
  check_num_parameters(theta.cols(), info_);
  check_target(target, info_, config_.store_every);
  Trajectories result = sim::replay(*model_, config_, target, theta);
  for (Index i = 0; i < theta.rows(); ++i) {
    RolloutStatus& status = result.status[static_cast<std::size_t>(i)];
    if (status != RolloutStatus::ok || is_possible(theta.row(i), info_)) continue;
    status = RolloutStatus::out_of_limits;
    std::ranges::fill(result.row(i), kFloatNaN);
  }
  return result;
}

std::unique_ptr<PolicyTask> OdeSimulator::policy_task(const PolicyTaskConfig& config) const {
  SimulatorInfo believed = info_;
  replace_nominal(config.model, believed, "policy.model");
  auto task = model_->control_task(complete_theta(believed, {}));
  if (!task) return nullptr;
  return std::make_unique<OdePolicyTask>(model_, std::move(task), info_, config_, config);
}

Target OdeSimulator::behave(const Vector& theta, Index num_rollouts, std::uint64_t seed) const {
  Target target = begin_target(theta, num_rollouts, info_);
  for (Index h = 0; h < num_rollouts; ++h) {
    target.rollouts.push_back(simulate(*model_, config_, theta, model_->excite(h, seed)));
    target.rollouts.back().name = "simulated " + std::to_string(h);
  }
  return target;
}

}  // namespace npdr::sim
