#include "pipeline/config/simulator_info.h"

#include <limits>

#include "core/feature_names.h"

namespace npdr::pipeline {
namespace {

sim::Parameter unlimited_parameter(const std::string& name, double value) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {name, "1", value, -infinity, infinity, ""};
}

}  // namespace

sim::SimulatorInfo simulator_info(const Study& study) {
  if (study.source().has_nominal) {
    sim::SimulatorConfig config;
    config.name = study.simulator.name;
    return sim::make_simulator(config)->info();
  }
  sim::SimulatorInfo info;
  info.name = study.source().name;
  for (const inference::Marginal& marginal : study.prior) {
    info.parameters.push_back(
        unlimited_parameter(marginal.name, std::numeric_limits<double>::quiet_NaN()));
  }
  for (const auto& [name, value] : study.simulator.parameters) {
    info.parameters.push_back(unlimited_parameter(name, value));
  }
  info.state_channels = parse_features(study.external.features);
  info.dt = 1.0;
  info.num_steps = 1;
  return info;
}

}  // namespace npdr::pipeline
