#include "sim/simulator_check.h"

#include <fmt/format.h>

#include <vector>

#include "core/text.h"

namespace npdr::sim {
namespace {

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

void replace_nominal(const std::map<std::string, double>& values, SimulatorInfo& info,
                     const std::string& field) {
  for (const auto& [name, value] : values) {
    Parameter& parameter = info.parameters[static_cast<std::size_t>(parameter_index(info, name))];
    if (!(value >= parameter.lower && value <= parameter.upper)) {
      throw InputError(fmt::format("{}.{} = {}, must be in [{}, {}] {}", field, name, value,
                                   parameter.lower, parameter.upper, parameter.unit));
    }
    parameter.nominal = value;
  }
}

void check_target(const Target& target, const SimulatorInfo& info, Index store_every) {
  target.check("target");
  check_channels("state", target.state_channels, info.state_channels, info.name);
  check_channels("action", target.action_channels, info.action_channels, info.name);
  if (store_every > target.num_steps()) {
    reject_setting(
        "store_every", store_every,
        "<= " + std::to_string(target.num_steps()) + ", the steps of the target's rollouts");
  }
}

void check_num_parameters(Index num_parameters, const SimulatorInfo& info) {
  const auto expected = static_cast<Index>(info.parameters.size());
  if (num_parameters == expected) return;
  throw ShapeError("theta has " + std::to_string(num_parameters) + " parameters, simulator '" +
                   info.name + "' has " + std::to_string(expected));
}

Target begin_target(const Vector& theta, Index num_rollouts, const SimulatorInfo& info) {
  check_num_parameters(theta.size(), info);
  if (num_rollouts < 1) reject_setting("num_rollouts", num_rollouts, ">= 1");
  Target target;
  target.dt = info.dt;
  target.state_channels = info.state_channels;
  target.action_channels = info.action_channels;
  target.source = "simulated by '" + info.name + "'";
  return target;
}

bool is_possible(const Eigen::Ref<const Eigen::RowVectorXd>& theta, const SimulatorInfo& info) {
  for (Index p = 0; p < theta.size(); ++p) {
    const Parameter& parameter = info.parameters[static_cast<std::size_t>(p)];
    if (!(theta(p) >= parameter.lower && theta(p) <= parameter.upper)) return false;
  }
  return true;
}

}  // namespace npdr::sim
