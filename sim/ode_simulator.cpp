#include "sim/ode_simulator.h"

#include <algorithm>
#include <limits>
#include <sstream>

#include "core/error.h"
#include "core/text.h"
#include "sim/batch_integrator.h"
#include "sim/replay.h"

namespace npdr::sim {
namespace {

template <typename Value>
[[noreturn]] void reject(const std::string& field, const Value& found, const std::string& allowed) {
  std::ostringstream message;
  message << "simulator." << field << " = " << found << ", must be " << allowed;
  throw InputError(message.str());
}

void check_config(const SimulatorConfig& config) {
  const bool adaptive = is_adaptive(config.integrator);
  if (config.segment_length < 0) reject("segment_length", config.segment_length, ">= 0");
  if (config.substeps < 1) reject("substeps", config.substeps, ">= 1");
  if (adaptive && config.substeps != 1) {
    reject("substeps", config.substeps,
           "1 with integrator '" + config.integrator + "', which picks its own steps");
  }
  if (config.store_every < 1) reject("store_every", config.store_every, ">= 1");
}

void replace_nominal(const std::map<std::string, double>& values, SimulatorInfo& info) {
  for (const auto& [name, value] : values) {
    Parameter& parameter = info.parameters[static_cast<std::size_t>(parameter_index(info, name))];
    if (!(value >= parameter.lower && value <= parameter.upper)) {
      std::ostringstream range;
      range << "in [" << parameter.lower << ", " << parameter.upper << "] " << parameter.unit;
      reject("parameters." + name, value, range.str());
    }
    parameter.nominal = value;
  }
}

std::string describe(const std::vector<Channel>& channels) {
  std::vector<std::string> parts;
  for (const Channel& channel : channels) {
    parts.push_back("'" + channel.label + "' [" + channel.unit + "]");
  }
  return join(parts);
}

void check_channels(const std::string& kind, const std::vector<Channel>& found,
                    const std::vector<Channel>& expected, const std::string& simulator) {
  if (found == expected) return;
  throw InputError("target has the " + kind + " channels " + describe(found) + "; simulator '" +
                   simulator + "' expects " + describe(expected));
}

}  // namespace

OdeSimulator::OdeSimulator(std::unique_ptr<OdeModel> model, const SimulatorConfig& config)
    : model_(std::move(model)), config_(config), info_(model_->info()) {
  check_config(config_);
  replace_nominal(config_.parameters, info_);
}

void OdeSimulator::check_target(const Target& target) const {
  target.check("target");
  check_channels("state", target.state_channels, info_.state_channels, info_.name);
  check_channels("action", target.action_channels, info_.action_channels, info_.name);
  if (config_.store_every > target.num_steps()) {
    reject("store_every", config_.store_every,
           "<= " + std::to_string(target.num_steps()) + ", the steps of the target's rollouts");
  }
}

void OdeSimulator::check_theta(Index num_parameters) const {
  const auto expected = static_cast<Index>(info_.parameters.size());
  if (num_parameters == expected) return;
  throw ShapeError("theta has " + std::to_string(num_parameters) + " parameters, simulator '" +
                   info_.name + "' has " + std::to_string(expected));
}

Trajectories OdeSimulator::replay(const Target& target, const RowMatrix& theta) const {
  check_theta(theta.cols());
  check_target(target);
  Trajectories result = sim::replay(*model_, config_, target, theta);
  for (Index i = 0; i < theta.rows(); ++i) {
    RolloutStatus& status = result.status[static_cast<std::size_t>(i)];
    if (status != RolloutStatus::ok || is_possible(theta.row(i))) continue;
    status = RolloutStatus::out_of_limits;
    std::ranges::fill(result.row(i), std::numeric_limits<float>::quiet_NaN());
  }
  return result;
}

bool OdeSimulator::is_possible(const Eigen::Ref<const Eigen::RowVectorXd>& theta) const {
  for (Index p = 0; p < theta.size(); ++p) {
    const Parameter& parameter = info_.parameters[static_cast<std::size_t>(p)];
    if (!(theta(p) >= parameter.lower && theta(p) <= parameter.upper)) return false;
  }
  return true;
}

Target OdeSimulator::behave(const Vector& theta, Index num_rollouts, std::uint64_t seed) const {
  check_theta(theta.size());
  if (num_rollouts < 1) reject("num_rollouts", num_rollouts, ">= 1");
  Target target;
  target.dt = info_.dt;
  target.state_channels = info_.state_channels;
  target.action_channels = info_.action_channels;
  target.source = "simulated by '" + info_.name + "'";
  for (Index h = 0; h < num_rollouts; ++h) {
    target.rollouts.push_back(simulate(*model_, config_, theta, model_->excite(h, seed)));
    target.rollouts.back().name = "simulated " + std::to_string(h);
  }
  return target;
}

}  // namespace npdr::sim
