/// Parts of key documents: of the settings, those that what is keyed depends on.
#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The settings of a method that a posterior depends on, whatever the method is called and however
/// many rounds follow.
nlohmann::ordered_json inference_json(const MethodConfig& method);

/// The resolved study as artefacts keep it: without what changes nothing in it, and with absolute
/// paths of libraries and models, which `npdr verify` loads from any folder.
nlohmann::ordered_json study_document(const Study& study);

/// A study's document with the names of its files alone, for keys: these count by what they hold,
/// in the keys of what is made of them, and not by where they lie as seen from the current folder.
nlohmann::ordered_json without_folders(nlohmann::ordered_json study);

}  // namespace npdr::pipeline
