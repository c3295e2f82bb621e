/// Parts of key documents: of the settings, those that what is keyed depends on.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The settings of a built-in simulator without those that mean nothing to it.
nlohmann::ordered_json simulator_json(const sim::SimulatorConfig& config);

/// The part that decides what a simulation of every state holds.
nlohmann::ordered_json dynamics_json(const sim::SimulatorConfig& config);

/// The part that decides what a simulated target holds, which is one segment.
nlohmann::ordered_json behaviour_json(const sim::SimulatorConfig& config);

/// Of a command or a dataset; `files`: the hashes of those that it names.
nlohmann::ordered_json external_json(const Study& study,
                                     const std::map<std::string, std::string>& files);

/// The settings of a method that a posterior depends on, whatever the method is called and however
/// many rounds follow.
nlohmann::ordered_json inference_json(const MethodConfig& method);

/// What decides how a policy's rollouts go: the task, and the policy that the search begins with.
nlohmann::ordered_json policy_task_json(const PolicyConfig& policy);

/// What a policy search depends on beside that.
nlohmann::ordered_json policy_search_json(const PolicyConfig& policy);

/// The resolved study as artefacts keep it: without what changes nothing in it.
nlohmann::ordered_json study_document(const Study& study);

}  // namespace npdr::pipeline
