/// The fields of a part of a study as data: what its description (study_fields.h) says of each, and
/// its value. What artefacts store, keys, lists of keys and of what means nothing are walks over
/// it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pipeline/config/field_use.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// A field, a table of fields, or a list of such tables.
struct Field {
  enum class Kind { value, table, list };

  Kind kind = Kind::value;
  std::string key;
  std::string doc;
  FieldUse use;
  nlohmann::ordered_json value = {};    ///< null where it is left out
  bool is_allowed = true;               ///< the value; a default that isn't makes a field required
  std::string type = {};                ///< such as "a finite number"
  std::string allowed = {};             ///< such as "> 0"; empty: everything of the type
  std::vector<std::string> names = {};  ///< the choices, where there are only a few
  std::vector<std::vector<Field>> members = {};  ///< of the table, or of each table of the list
};
using Fields = std::vector<Field>;

/// Config is one of Study, SimulatorTable, ObservationNoise, MethodConfig, DiagnoseConfig,
/// PolicyConfig, ClusterConfig, PublishedFigure, sim::SimulatorConfig, inference::EmbeddingConfig,
/// TrainedEmbeddingConfig, EstimatorConfig, TrainingConfig, AlgorithmConfig, SamplerConfig.
template <class Config>
Fields fields_of(const Config& config);
/// Those of a method in a study with that policy.
Fields fields_of(const MethodConfig& method, const PolicyConfig& policy);

/// A field, or a table as a whole, that means nothing where it is.
struct UnusedField {
  std::string path;
  FieldUse use;
};
/// `path` begins theirs.
std::vector<UnusedField> unused_fields(const Fields& fields, const std::string& path);

/// Whether `key` of a [[method]] means something to the algorithm.
bool reads_setting(inference::Algorithm algorithm, const std::string& key);

}  // namespace npdr::pipeline
