/// Studies as JSON: what artefacts store and what content keys are made of.
///
/// Every field is written, defaults included, in a fixed order. Marginals are written as
/// {"name": ..., "unit": ..., "uniform": [low, high]}, so that their order, which is that of the
/// columns of theta, survives any JSON library.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/config/field_list.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Those whose use `is_kept`.
nlohmann::ordered_json json_of(const Fields& fields,
                               const std::function<bool(const FieldUse&)>& is_kept);

/// A study, whose tables have the names of the study file's, or one part of it (fields_of()).
template <class Config>
nlohmann::ordered_json to_json(const Config& config) {
  return json_of(fields_of(config), [](const FieldUse&) { return true; });
}
nlohmann::ordered_json to_json(const std::vector<inference::Marginal>& prior);

/// The fields of a part that mean something and whose values are part of these artefacts' keys.
template <class Config>
nlohmann::ordered_json key_json(const Config& config, Affects affects = Affects::results) {
  return json_of(fields_of(config), [affects](const FieldUse& use) {
    return use.affects == affects && use.unused.empty();
  });
}

/// The study without what affects nothing, and without fields that its documents are older than.
nlohmann::ordered_json document_json(const Study& study);

/// The inverse of to_json() for the parts that a posterior artefact needs to be used again: Config
/// is one of sim::SimulatorConfig, SimulatorTable, inference::EmbeddingConfig, EstimatorConfig,
/// TrainingConfig, AlgorithmConfig, SamplerConfig. `where` (a file name) begins the message of the
/// InputError that an unknown key, a wrong type or a value that isn't allowed throws. A missing key
/// keeps its default, where that is allowed.
template <class Config>
Config from_json(const nlohmann::ordered_json& json, const std::string& where);

/// The inverse of to_json() of a prior. Throws InputError.
std::vector<inference::Marginal> prior_from_json(const nlohmann::ordered_json& json,
                                                 const std::string& where);

}  // namespace npdr::pipeline
