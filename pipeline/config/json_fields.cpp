#include "pipeline/config/json_fields.h"

#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
// Ordered objects look for each new member among all before it; sorted ones, as this is, don't.
Json json_value(const FreeTable& table) { return nlohmann::json::parse(table.json); }

Json json_value(const std::map<std::string, PublishedFigure>& figures) {
  Json json = Json::object();
  for (auto [name, figure] : figures) {
    JsonWriter members;
    describe(members, figure);
    json[name] = members.json();
  }
  return json;
}

Json json_value(const std::vector<inference::Marginal>& prior) {
  Json json = Json::array();
  for (const inference::Marginal& marginal : prior) {
    json.push_back({{"name", marginal.name},
                    {"unit", marginal.unit},
                    {name_of(marginal.kind), {marginal.a, marginal.b}}});
  }
  return json;
}

}  // namespace npdr::pipeline
