#include <algorithm>
#include <array>
#include <span>

#include "core/error.h"
#include "core/text.h"
#include "sim/furuta.h"
#include "sim/minigolf/minigolf.h"
#include "sim/ode_simulator.h"
#include "sim/pendulum.h"
#include "sim/simulator.h"

namespace npdr::sim {
namespace {

using SimulatorPtr = std::unique_ptr<Simulator>;

template <typename Model>
SimulatorPtr make_ode_simulator(const SimulatorConfig& config) {
  return std::make_unique<OdeSimulator>(std::make_unique<Model>(), config);
}

SimulatorPtr make_minigolf(const SimulatorConfig& config) {
  return std::make_unique<Minigolf>(config);
}

struct Entry {
  const char* name;
  SimulatorPtr (*make)(const SimulatorConfig&);
  std::span<const char* const> unused_settings;
  int rollout_version = 1;
};

constexpr std::array kNotOfOdes = {"minigolf"};
constexpr std::array kOfOdes = {"segment_length", "integrator", "substeps"};

// Every simulator: to add one, write its file pair and a line here.
constexpr std::array kSimulators = {
    Entry{"furuta", make_ode_simulator<Furuta>, kNotOfOdes},
    Entry{"minigolf", make_minigolf, kOfOdes, 2},
    Entry{"pendulum", make_ode_simulator<Pendulum>, kNotOfOdes},
};

const Entry& find_entry(const std::string& name) {
  const auto found = std::ranges::find(kSimulators, name, &Entry::name);
  if (found == kSimulators.end()) {
    throw InputError(unknown_name("simulator", name, simulator_names()));
  }
  return *found;
}

}  // namespace

std::vector<std::string> simulator_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kSimulators) names.emplace_back(entry.name);
  return names;
}

std::unique_ptr<Simulator> make_simulator(const SimulatorConfig& config) {
  return find_entry(config.name).make(config);
}

std::vector<std::string> unused_settings(const std::string& name) {
  const Entry& entry = find_entry(name);
  return {entry.unused_settings.begin(), entry.unused_settings.end()};
}

int rollout_version(const std::string& name) { return find_entry(name).rollout_version; }

std::vector<Outline> Simulator::outlines(const Vector& /*theta*/) const { return {}; }

std::unique_ptr<RegressionForm> Simulator::regression_form() const { return nullptr; }

std::unique_ptr<PolicyTask> Simulator::policy_task(const PolicyTaskConfig& /*config*/) const {
  return nullptr;
}

std::vector<std::string> simulators_with_regression() {
  std::vector<std::string> names;
  for (const std::string& name : simulator_names()) {
    if (make_simulator({.name = name})->regression_form()) names.push_back(name);
  }
  return names;
}

Index parameter_index(const SimulatorInfo& info, const std::string& name) {
  std::vector<std::string> names;
  for (const Parameter& parameter : info.parameters) names.push_back(parameter.name);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) throw InputError(unknown_name(info.name + " parameter", name, names));
  return found - names.begin();
}

Vector complete_theta(const Simulator& simulator, const std::map<std::string, double>& values) {
  return complete_theta(simulator.info(), values);
}

Vector complete_theta(const SimulatorInfo& info, const std::map<std::string, double>& values) {
  Vector theta(static_cast<Index>(info.parameters.size()));
  for (std::size_t p = 0; p < info.parameters.size(); ++p) {
    theta(static_cast<Index>(p)) = info.parameters[p].nominal;
  }
  for (const auto& [name, value] : values) theta(parameter_index(info, name)) = value;
  return theta;
}

}  // namespace npdr::sim
