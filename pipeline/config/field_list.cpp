#include "pipeline/config/field_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include "pipeline/config/study_fields.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

namespace {

template <class T>
Json json_value(const T& value) {
  return value;
}

template <class T>
Json json_value(const std::optional<T>& value) {
  return value ? json_value(*value) : Json();
}

// Ordered objects look for each new member among all before it; sorted ones, as this is, don't.
Json json_value(const FreeTable& table) { return nlohmann::json::parse(table.json); }

Json json_value(const std::map<std::string, PublishedFigure>& figures) {
  Json json = Json::object();
  for (const auto& [name, figure] : figures) json[name] = to_json(figure);
  return json;
}

Json json_value(const std::vector<inference::Marginal>& prior) { return to_json(prior); }

// The visitor that notes down all that it is told.
class FieldLister {
 public:
  template <class T, class C>
  void operator()(const std::string& key, const T& value, const Constraint<C>& allowed,
                  std::string_view doc, const FieldUse& use = {}) {
    fields_.push_back({.key = key,
                       .doc = std::string(doc),
                       .use = use,
                       .value = json_value(value),
                       .is_allowed = satisfies(value, allowed),
                       .type = type_name<T>(),
                       .allowed = allowed.words,
                       .names = allowed.names});
  }

  template <class Body>
  void table(const std::string& key, std::string_view doc, const Body& body,
             const FieldUse& use = {}) {
    FieldLister members;
    body(members);
    fields_.push_back({Field::Kind::table, key, std::string(doc), use});
    fields_.back().members = {members.fields_};
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int /*minimum*/, std::string_view doc,
            const Body& body, const FieldUse& use = {}) {
    fields_.push_back({Field::Kind::list, key, std::string(doc), use});
    for (T& value : values) {
      FieldLister members;
      body(members, value);
      fields_.back().members.push_back(members.fields_);
    }
  }

  const Fields& fields() const { return fields_; }

 private:
  Fields fields_;
};

// `config`: a copy, since the description is the readers', too, and takes what it can change.
template <class Config, class... Context>
Fields list_fields(Config config, const Context&... context) {
  FieldLister lister;
  describe(lister, config, context...);
  return lister.fields();
}

void add_unused(const Fields& fields, const std::string& prefix, std::vector<UnusedField>& found) {
  for (const Field& field : fields) {
    const std::string path = prefix + field.key;
    if (!field.use.unused.empty()) {
      found.push_back({path, field.use});
      continue;
    }
    for (std::size_t i = 0; i < field.members.size(); ++i) {
      const bool is_list = field.kind == Field::Kind::list;
      add_unused(field.members[i], is_list ? fmt::format("{}[{}].", path, i) : path + ".", found);
    }
  }
}

}  // namespace

template <class Config>
Fields fields_of(const Config& config) {
  return list_fields(config);
}

Fields fields_of(const MethodConfig& method, const PolicyConfig& policy) {
  return list_fields(method, policy);
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

template Fields fields_of(const Study&);
template Fields fields_of(const SimulatorTable&);
template Fields fields_of(const ObservationNoise&);
template Fields fields_of(const MethodConfig&);
template Fields fields_of(const DiagnoseConfig&);
template Fields fields_of(const PolicyConfig&);
template Fields fields_of(const ClusterConfig&);
template Fields fields_of(const PublishedFigure&);
template Fields fields_of(const sim::SimulatorConfig&);
template Fields fields_of(const inference::EmbeddingConfig&);
template Fields fields_of(const inference::TrainedEmbeddingConfig&);
template Fields fields_of(const inference::EstimatorConfig&);
template Fields fields_of(const inference::TrainingConfig&);
template Fields fields_of(const inference::AlgorithmConfig&);
template Fields fields_of(const inference::SamplerConfig&);

}  // namespace npdr::pipeline
