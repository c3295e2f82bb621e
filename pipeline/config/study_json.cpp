#include "pipeline/config/study_json.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/field_reader.h"
#include "pipeline/config/json_fields.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {

namespace {

template <class Config>
Json write(Config copy, std::function<bool(const FieldUse&)> is_kept) {
  JsonWriter writer(std::move(is_kept));
  describe(writer, copy);  // it is the readers', too, and takes what it can change
  return writer.json();
}

}  // namespace

template <class Config>
Json to_json(const Config& config) {
  return write(config, nullptr);
}

Json to_json(const Study& study) { return to_json<Study>(study); }

template <class Config>
Json key_json(const Config& config, Affects affects) {
  return write(config, [affects](const FieldUse& use) {
    return use.affects == affects && use.unused.empty();
  });
}

Json document_json(const Study& study) {
  return write(study,
               [](const FieldUse& use) { return use.affects != Affects::nothing && !use.omitted; });
}

Json to_json(const std::vector<inference::Marginal>& prior) { return json_value(prior); }

template <class Config>
Config from_json(const Json& json, const std::string& where) {
  if (!json.is_object()) throw InputError(where + ": must be a JSON object");
  Config config;
  const nlohmann::json document = json;
  Reading reading = Reading::of_json(where);
  FieldReader reader(&document, "", reading);
  describe(reader, config);
  reader.reject_unknown_keys();
  reading.problems().throw_if_any();
  return config;
}

namespace {

bool read_marginal(const nlohmann::json& json, Reading& reading, inference::Marginal& marginal) {
  return json.is_object() && json.size() == 3 && json.contains("name") && json.contains("unit") &&
         read_value({json["name"], "name", reading}, marginal.name) &&
         read_value({json["unit"], "unit", reading}, marginal.unit) &&
         read_distribution({json, "", reading}, marginal);
}

}  // namespace

std::vector<inference::Marginal> prior_from_json(const Json& json, const std::string& where) {
  Reading reading = Reading::of_json(where);
  std::vector<inference::Marginal> prior;
  const auto read = [&](const Json& marginal) {
    return read_marginal(marginal, reading, prior.emplace_back());
  };
  if (json.is_array() && std::ranges::all_of(json, read)) return prior;
  throw InputError(where + ": prior = " + shortened(json.dump()) +
                   R"(, must be a list of {"name", "unit", "uniform": [low, high]})");
}

template Json to_json(const sim::SimulatorConfig&);
template Json to_json(const inference::EmbeddingConfig&);
template Json to_json(const inference::TrainedEmbeddingConfig&);
template Json to_json(const inference::EstimatorConfig&);
template Json to_json(const inference::TrainingConfig&);
template Json to_json(const inference::AlgorithmConfig&);
template Json to_json(const inference::SamplerConfig&);
template Json to_json(const ObservationNoise&);
template Json to_json(const MethodConfig&);
template Json to_json(const DiagnoseConfig&);
template Json to_json(const PolicyConfig&);

template Json key_json(const SimulatorTable&, Affects);
template Json key_json(const ObservationNoise&, Affects);
template Json key_json(const MethodConfig&, Affects);
template Json key_json(const DiagnoseConfig&, Affects);
template Json key_json(const PolicyConfig&, Affects);

template sim::SimulatorConfig from_json(const Json&, const std::string&);
template SimulatorTable from_json(const Json&, const std::string&);
template inference::EmbeddingConfig from_json(const Json&, const std::string&);
template inference::TrainedEmbeddingConfig from_json(const Json&, const std::string&);
template inference::EstimatorConfig from_json(const Json&, const std::string&);
template inference::TrainingConfig from_json(const Json&, const std::string&);
template inference::AlgorithmConfig from_json(const Json&, const std::string&);
template inference::SamplerConfig from_json(const Json&, const std::string&);

}  // namespace npdr::pipeline
