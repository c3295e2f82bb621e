/// Parts of key documents: of the settings, those that what is keyed depends on.
#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The settings of a method that a posterior depends on, whatever the method is called and however
/// many rounds follow.
nlohmann::ordered_json inference_json(const MethodConfig& method);

/// Settings of the noise itself, whatever a training does with it.
nlohmann::ordered_json noise_json(const ObservationNoise& noise);

/// Settings that decide how a policy's rollouts go: the task, and the policy that the search
/// begins with.
nlohmann::ordered_json policy_task_json(const PolicyConfig& policy);

/// Settings that a policy search depends on beside those.
nlohmann::ordered_json policy_search_json(const PolicyConfig& policy);

/// The resolved study as artefacts keep it: without what changes nothing in it, and with absolute
/// paths of libraries and models, which `npdr verify` loads from any folder.
nlohmann::ordered_json study_document(const Study& study);

/// A study's document with the names of its files alone, for keys: these count by what they hold,
/// in the keys of what is made of them, and not by where they lie as seen from the current folder.
nlohmann::ordered_json without_folders(nlohmann::ordered_json study);

}  // namespace npdr::pipeline
