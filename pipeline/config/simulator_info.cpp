#include "pipeline/config/simulator_info.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>

#include "core/constants.h"
#include "core/error.h"
#include "core/feature_names.h"
#include "pipeline/process/child_process.h"
#include "pipeline/process/progress.h"

namespace npdr::pipeline {
namespace {

namespace fs = std::filesystem;

// Beside the executables, or where an environment variable says.
fs::path mujoco_library() {
  const char* const given = std::getenv("NPDR_MUJOCO_LIBRARY");
  const fs::path file = given != nullptr
                            ? fs::path(given)
                            : executable_folder().parent_path() / "lib" / "npdr_mujoco.so";
  std::error_code unreadable;
  if (!fs::exists(file, unreadable)) {
    throw InputError("simulator.mjcf needs MuJoCo, which npdr was built without: " + file.string() +
                     " isn't there; 'pip install mujoco', then build npdr again with "
                     "'scripts/build' (docs/external-simulators.md)");
  }
  return file;
}

// Requests of the study to the model, in an order that doesn't depend on the prior's; without a
// prior, all that the model has.
nlohmann::ordered_json mujoco_settings(const Study& study) {
  std::set<std::string> parameters;
  const auto add_names = [&](const std::map<std::string, double>& values) {
    for (const auto& [name, value] : values) parameters.insert(name);
  };
  for (const inference::Marginal& marginal : study.prior) parameters.insert(marginal.name);
  add_names(study.simulator.parameters);
  if (study.target.truth) add_names(*study.target.truth);
  for (const ReferenceConfig& reference : study.references) add_names(reference.parameters);
  return {{"model", fs::absolute(*study.external.mjcf).string()},
          {"parameters",
           parameters.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(parameters)},
          {"states", study.external.states},
          {"actions", study.external.actions}};
}

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

sim::LibraryConfig library_config(const Study& study) {
  const ExternalConfig& external = study.external;
  const std::string advice =
      external.mjcf ? ", or narrow the prior"
                    : "; where one of them comes to no end, bound the library's loops and give it "
                      "the status NPDR_DIVERGED";
  const auto end_late = [advice](const std::string& message) {
    report_error("npdr",
                 message + ": raise simulator.time_limit where rows take that long" + advice);
    _exit(static_cast<int>(ExitStatus::invalid_input));
  };
  return {external.mjcf ? mujoco_library() : fs::path(*external.library),
          external.mjcf ? mujoco_settings(study).dump() : external.settings.json, external.folder,
          external.time_limit, end_late};
}

sim::SimulatorInfo simulator_info(const Study& study) {
  const SourceTraits& source = study.source();
  if (source.is_built_in) return sim::make_simulator({.name = study.simulator.name})->info();
  sim::SimulatorInfo info = source.describes_itself
                                ? sim::LibrarySimulator(library_config(study)).info()
                                : info_of_study(study);
  info.dt = source.gives_motion ? study.external.dt : 1.0;
  info.num_steps = source.gives_motion ? study.external.num_steps : 1;
  info.goal = goal_of(study.external.goal, info.state_channels);
  return info;
}

}  // namespace npdr::pipeline
