/// Studies as JSON: what artefacts store and what content keys are made of.
///
/// Every field is written, defaults included, in a fixed order. Marginals are written as
/// {"name": ..., "unit": ..., "uniform": [low, high]}, so that their order, which is that of the
/// columns of theta, survives any JSON library.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "pipeline/config/field_use.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The resolved study. Its tables have the names of the study file's.
nlohmann::ordered_json to_json(const Study& study);

/// One part of a study. Config is one of sim::SimulatorConfig, inference::EmbeddingConfig,
/// EstimatorConfig, TrainingConfig, AlgorithmConfig, SamplerConfig; ObservationNoise, MethodConfig,
/// DiagnoseConfig, PolicyConfig.
template <class Config>
nlohmann::ordered_json to_json(const Config& config);

nlohmann::ordered_json to_json(const std::vector<inference::Marginal>& prior);

/// The fields of a part that mean something and whose values are part of these artefacts' keys.
/// Config is one of SimulatorTable, ObservationNoise, MethodConfig, DiagnoseConfig, PolicyConfig.
template <class Config>
nlohmann::ordered_json key_json(const Config& config, Affects affects = Affects::results);

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
