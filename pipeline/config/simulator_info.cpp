#include "pipeline/config/simulator_info.h"

#include <algorithm>

#include "core/constants.h"
#include "core/feature_names.h"
#include "pipeline/config/library_config.h"
#include "sim/library/library_simulator.h"

namespace npdr::pipeline {
namespace {

sim::Parameter described(const DescribedParameter& c) {
  return {c.name,
          c.unit,
          c.nominal.value_or(kNaN),
          c.lower.value_or(-kInfinity),
          c.upper.value_or(kInfinity),
          c.description,
          c.period};
}

// Those that the study describes; where it describes none, all that it names.
std::vector<sim::Parameter> parameters_of(const Study& study) {
  std::vector<sim::Parameter> all;
  for (const DescribedParameter& parameter : study.external.parameters) {
    all.push_back(described(parameter));
  }
  if (!all.empty()) return all;
  for (const inference::Marginal& marginal : study.prior) {
    all.push_back(described({.name = marginal.name}));
  }
  for (const auto& [name, value] : study.simulator.parameters) {
    all.push_back(described({.name = name, .nominal = value}));
  }
  return all;
}

std::optional<Goal> goal_of(const GoalConfig& config, const std::vector<Channel>& states) {
  if (config.radius == 0.0) return std::nullopt;
  Goal goal{
      config.description, {}, {}, config.radius, config.speed > 0.0 ? config.speed : kInfinity};
  std::vector<double> place;
  for (const auto& [label, value] : config.place) {
    const auto channel = std::ranges::find(states, label, &Channel::label);
    if (channel == states.end()) continue;  // study_check.cpp reports it
    place.push_back(value);
    goal.channels.push_back(channel - states.begin());
  }
  goal.place = Eigen::Map<const Vector>(place.data(), std::ssize(place));
  return goal;
}

sim::SimulatorInfo info_of_study(const Study& study) {
  sim::SimulatorInfo info;
  info.name = study.source().name;
  info.parameters = parameters_of(study);
  const bool gives_motion = study.source().gives_motion;
  info.state_channels =
      parse_features(gives_motion ? study.external.states : study.external.features);
  info.action_channels = parse_features(study.external.actions);
  return info;
}

}  // namespace

sim::SimulatorInfo simulator_info(const Study& study) {
  const SourceTraits& source = study.source();
  if (source.is_built_in) {
    sim::SimulatorConfig config;
    config.name = study.simulator.name;
    return sim::make_simulator(config)->info();
  }
  sim::SimulatorInfo info = source.describes_itself
                                ? sim::LibrarySimulator(library_config(study)).info()
                                : info_of_study(study);
  info.dt = source.gives_motion ? study.external.dt : 1.0;
  info.num_steps = source.gives_motion ? study.external.num_steps : 1;
  info.goal = goal_of(study.external.goal, info.state_channels);
  return info;
}

}  // namespace npdr::pipeline
