#include "pipeline/config/features.h"

#include <fmt/format.h>

#include <limits>

namespace npdr::pipeline {
namespace {

constexpr const char* kNoUnit = "1";

sim::Parameter unlimited_parameter(const std::string& name, double value) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {name, kNoUnit, value, -infinity, infinity, ""};
}

}  // namespace

Channel feature_of(const std::string& name) {
  const std::size_t open = name.rfind('[');
  const bool has_unit = open != std::string::npos && open > 0 && name[open - 1] == ' ';
  if (!has_unit || name.back() != ']') return {name, kNoUnit};  // "x[0]" is a name
  const std::string label = name.substr(0, open);
  return {label.substr(0, label.find_last_not_of(" \t") + 1),
          name.substr(open + 1, name.size() - open - 2)};
}

std::vector<Channel> features_of(const std::vector<std::string>& names) {
  std::vector<Channel> features;
  for (const std::string& name : names) features.push_back(feature_of(name));
  return features;
}

std::string feature_name(const Channel& feature) {
  return feature.unit == kNoUnit ? feature.label
                                 : fmt::format("{} [{}]", feature.label, feature.unit);
}

std::vector<std::string> feature_names(const std::vector<Channel>& features) {
  std::vector<std::string> names;
  for (const Channel& feature : features) names.push_back(feature_name(feature));
  return names;
}

std::vector<Channel> numbered_features(Index count) {
  std::vector<Channel> features;
  for (Index f = 0; f < count; ++f) features.push_back({fmt::format("x{}", f), kNoUnit});
  return features;
}

sim::SimulatorInfo simulator_info(const Study& study) {
  if (!study.external.is_used()) {
    sim::SimulatorConfig config;
    config.name = study.simulator.name;
    return sim::make_simulator(config)->info();
  }
  sim::SimulatorInfo info;
  info.name = study.external.command ? "command" : "dataset";
  for (const inference::Marginal& marginal : study.prior) {
    info.parameters.push_back(
        unlimited_parameter(marginal.name, std::numeric_limits<double>::quiet_NaN()));
  }
  for (const auto& [name, value] : study.simulator.parameters) {
    info.parameters.push_back(unlimited_parameter(name, value));
  }
  info.state_channels = features_of(study.external.features);
  info.dt = 1.0;
  info.num_steps = 1;
  return info;
}

}  // namespace npdr::pipeline
