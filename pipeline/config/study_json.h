/// The fields of a part of a study as data: what its description (study_fields.h) says of each, and
/// its value. What artefacts store, keys, lists of keys and of what means nothing are walks over
/// it.
///
/// As JSON every field is written, defaults included, in a fixed order. Marginals are written as
/// {"name": ..., "unit": ..., "uniform": [low, high]}, so that their order, which is that of the
/// columns of theta, survives any JSON library.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/error.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// The artefacts whose keys a field's value is part of. What changes any key but those of nothing
/// changes the report's, too.
enum class Affects {
  results,    ///< all that its table is about: key_json() writes it as it stands
  training,   ///< posteriors of networks alone
  task,       ///< closed loops of a policy, and the search for it
  elsewhere,  ///< those that a plan or a source notes down by hand: what a file holds, which rounds
  report,     ///< the report's alone
  nothing,
};

/// A field that says nothing means something everywhere, and affects all that its table is about.
/// What a table says holds for its members.
struct FieldUse {
  Affects affects = Affects::results;
  std::string unused = {};  ///< end of "... must be left out"; "": it means something
  bool settable = false;    ///< by --set where it is unused: that may be meant for others
  bool omitted = false;     ///< from documents of studies, which are older than the field
};

/// FieldUse::unused: "" where the field means something, else ": why".
inline std::string unless(bool means_something, const std::string& why) {
  return means_something ? "" : ": " + why;
}

/// A field, a table of fields, or a list of such tables.
struct Field {
  enum class Kind { value, table, list };

  Kind kind = Kind::value;
  std::string path;  ///< within the part: "training.learning_rate", "method[0].name"
  std::string key;   ///< its last name
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

/// Reads `config` from a file's `table` (nullptr: all is left out), notes down in `reading` what is
/// wrong there, and lists the fields. Config is one of Study, SimulatorTable, ObservationNoise,
/// MethodConfig (in a study with the PolicyConfig `context`, if any), DiagnoseConfig, PolicyConfig,
/// ClusterConfig, PublishedFigure, sim::SimulatorConfig, inference::EmbeddingConfig,
/// TrainedEmbeddingConfig, EstimatorConfig, TrainingConfig, AlgorithmConfig, SamplerConfig.
template <class Config, class... Context>
Fields read_fields(Config& config, const nlohmann::json* table, Reading& reading,
                   const Context&... context);

template <class Config, class... Context>
Fields fields_of(Config config, const Context&... context) {
  Reading unheard("");
  return read_fields(config, nullptr, unheard, context...);
}

/// A field, or a table as a whole, that means nothing where it is.
struct UnusedField {
  std::string path;
  FieldUse use;
};
/// `path` begins theirs.
std::vector<UnusedField> unused_fields(const Fields& fields, const std::string& path);

/// Whether `key` of a [[method]] means something to the algorithm.
bool reads_setting(inference::Algorithm algorithm, const std::string& key);

/// Those whose use `is_kept`.
nlohmann::ordered_json json_of(const Fields& fields,
                               const std::function<bool(const FieldUse&)>& is_kept);

/// A study, whose tables have the names of the study file's, or one part of it (fields_of()).
template <class Config>
nlohmann::ordered_json to_json(const Config& config) {
  return json_of(fields_of(config), [](const FieldUse&) { return true; });
}
/// For keys: without physical ends, which affect the report alone.
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

/// The inverse of to_json() for a part of a study. `where` (a file name) begins the message of the
/// InputError that an unknown key, a wrong type or a value that isn't allowed throws. A missing key
/// keeps its default, where that is allowed.
template <class Config>
Config from_json(const nlohmann::ordered_json& json, const std::string& where) {
  if (!json.is_object()) throw InputError(where + ": must be a JSON object");
  Config config;
  Reading reading(where, Reading::Syntax::json);
  const nlohmann::json sorted = json;
  read_fields(config, &sorted, reading);
  reading.throw_if_bad();
  return config;
}

/// The inverse of to_json() of a prior. Throws InputError.
std::vector<inference::Marginal> prior_from_json(const nlohmann::ordered_json& json,
                                                 const std::string& where);

}  // namespace npdr::pipeline
