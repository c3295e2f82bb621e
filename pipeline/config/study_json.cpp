#include "pipeline/config/study_json.h"

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/field_reader.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

Json json_of(const Fields& fields, const std::function<bool(const FieldUse&)>& is_kept) {
  Json json = Json::object();
  for (const Field& field : fields) {
    if (!is_kept(field.use)) continue;
    if (field.kind == Field::Kind::value) {
      if (!field.value.is_null()) json[field.key] = field.value;
    } else if (field.kind == Field::Kind::table) {
      json[field.key] = json_of(field.members.front(), is_kept);
    } else {
      Json& tables = json[field.key] = Json::array();
      for (const Fields& members : field.members) tables.push_back(json_of(members, is_kept));
    }
  }
  return json;
}

Json document_json(const Study& study) {
  return json_of(fields_of(study), [](const FieldUse& use) {
    return use.affects != Affects::nothing && !use.omitted;
  });
}

Json to_json(const std::vector<inference::Marginal>& prior) {
  Json json = Json::array();
  for (const inference::Marginal& marginal : prior) {
    json.push_back({{"name", marginal.name},
                    {"unit", marginal.unit},
                    {name_of(marginal.kind), {marginal.a, marginal.b}}});
  }
  return json;
}

template <class Config>
Config from_json(const Json& json, const std::string& where) {
  if (!json.is_object()) throw InputError(where + ": must be a JSON object");
  Config config;
  const nlohmann::json document = json;
  Reading reading = Reading::of_json(where);
  FieldReader reader(&document, "", reading);
  describe(reader, config);
  reader.reject_unknown_keys();
  reading.throw_if_bad();
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

template sim::SimulatorConfig from_json(const Json&, const std::string&);
template SimulatorTable from_json(const Json&, const std::string&);
template inference::EmbeddingConfig from_json(const Json&, const std::string&);
template inference::TrainedEmbeddingConfig from_json(const Json&, const std::string&);
template inference::EstimatorConfig from_json(const Json&, const std::string&);
template inference::TrainingConfig from_json(const Json&, const std::string&);
template inference::AlgorithmConfig from_json(const Json&, const std::string&);
template inference::SamplerConfig from_json(const Json&, const std::string&);

}  // namespace npdr::pipeline
