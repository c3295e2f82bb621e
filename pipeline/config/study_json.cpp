#include "pipeline/config/study_json.h"

#include <algorithm>

#include "core/text.h"
#include "pipeline/config/field_reader.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

namespace {

void add_unused(const Fields& fields, const std::string& prefix, std::vector<UnusedField>& found) {
  for (const Field& field : fields) {
    if (!field.use.unused.empty()) {
      found.push_back({prefix + field.path, field.use});
      continue;
    }
    for (const Fields& members : field.members) add_unused(members, prefix, found);
  }
}

bool read_marginal(const nlohmann::json& json, Reading& reading, inference::Marginal& marginal) {
  return json.is_object() && json.size() == 3 + num_beside_kind(json) && json.contains("name") &&
         json.contains("unit") && read_value({json["name"], "name", reading}, marginal.name) &&
         read_value({json["unit"], "unit", reading}, marginal.unit) &&
         read_distribution({json, "", reading}, marginal);
}

}  // namespace

// Ordered objects look for each new member among all before it; sorted ones, as this is, don't.
Json json_value(const FreeTable& table) { return nlohmann::json::parse(table.json); }

Json json_value(const std::map<std::string, PublishedFigure>& figures) {
  Json json = Json::object();
  for (const auto& [name, figure] : figures) json[name] = to_json(figure);
  return json;
}

// Unlike keys, documents say what affects the report alone.
Json json_value(const std::vector<inference::Marginal>& prior) {
  Json json = to_json(prior);
  for (std::size_t d = 0; d < prior.size(); ++d) {
    if (prior[d].physical == inference::PhysicalEnds::none) continue;
    json[d][kPhysical] = name_of(prior[d].physical);
  }
  return json;
}

template <class Config, class... Context>
Fields read_fields(Config& config, const FieldTree* table, Reading& reading,
                   const Context&... context) {
  return FieldReader(table, "", reading).read([&](auto& fields) {
    describe(fields, config, context...);
  });
}

std::vector<UnusedField> unused_fields(const Fields& fields, const std::string& path) {
  std::vector<UnusedField> found;
  add_unused(fields, path.empty() ? "" : path + ".", found);
  return found;
}

bool reads_setting(inference::Algorithm algorithm, const std::string& key) {
  MethodConfig method;
  method.algorithm.kind = algorithm;
  PolicyConfig any;
  any.search.kind = inference::PolicyOptimizerKind::power;
  const std::vector<UnusedField> unused = unused_fields(fields_of(method, any), "");
  return std::ranges::count(unused, key, &UnusedField::path) == 0;
}

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
    if (std::isfinite(marginal.from)) json.back()[kLower] = marginal.from;
    if (std::isfinite(marginal.to)) json.back()[kUpper] = marginal.to;
  }
  return json;
}

std::vector<inference::Marginal> prior_from_json(const Json& json, const std::string& where) {
  Reading reading(where, Reading::Syntax::json);
  std::vector<inference::Marginal> prior;
  const auto read = [&](const Json& marginal) {
    return read_marginal(marginal, reading, prior.emplace_back());
  };
  if (json.is_array() && std::ranges::all_of(json, read)) return prior;
  throw InputError(where + ": prior = " + shortened(json.dump()) +
                   R"(, must be a list of {"name", "unit", "uniform": [low, high]})");
}

template Fields read_fields(Study&, const FieldTree*, Reading&);
template Fields read_fields(SimulatorTable&, const FieldTree*, Reading&);
template Fields read_fields(ObservationNoise&, const FieldTree*, Reading&);
template Fields read_fields(MethodConfig&, const FieldTree*, Reading&);
template Fields read_fields(MethodConfig&, const FieldTree*, Reading&, const PolicyConfig&);
template Fields read_fields(DiagnoseConfig&, const FieldTree*, Reading&);
template Fields read_fields(PolicyConfig&, const FieldTree*, Reading&);
template Fields read_fields(ClusterConfig&, const FieldTree*, Reading&);
template Fields read_fields(PublishedFigure&, const FieldTree*, Reading&);
template Fields read_fields(sim::SimulatorConfig&, const FieldTree*, Reading&);
template Fields read_fields(inference::EmbeddingConfig&, const FieldTree*, Reading&);
template Fields read_fields(inference::TrainedEmbeddingConfig&, const FieldTree*, Reading&);
template Fields read_fields(inference::EstimatorConfig&, const FieldTree*, Reading&);
template Fields read_fields(inference::TrainingConfig&, const FieldTree*, Reading&);
template Fields read_fields(inference::AlgorithmConfig&, const FieldTree*, Reading&);
template Fields read_fields(inference::SamplerConfig&, const FieldTree*, Reading&);

}  // namespace npdr::pipeline
