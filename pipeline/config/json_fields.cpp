#include "pipeline/config/json_fields.h"

#include <algorithm>

#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
namespace {

bool read_marginal(const Json& json, inference::Marginal& marginal) {
  if (!json.is_object() || json.size() != 3) return false;
  const auto name = json.find("name");
  const auto unit = json.find("unit");
  if (name == json.end() || unit == json.end()) return false;
  if (!read_value(*name, marginal.name) || !read_value(*unit, marginal.unit)) return false;
  for (const auto& [key, bounds] : json.items()) {
    const auto kind = value_named<inference::Marginal::Kind>(key);
    if (!kind) continue;
    marginal.kind = *kind;
    return bounds.is_array() && bounds.size() == 2 && read_value(bounds[0], marginal.a) &&
           read_value(bounds[1], marginal.b);
  }
  return false;
}

template <class T>
bool read_list(const Json& json, std::vector<T>& values, bool (*read)(const Json&, T&)) {
  if (!json.is_array()) return false;
  values.clear();
  return std::all_of(json.begin(), json.end(),
                     [&](const Json& element) { return read(element, values.emplace_back()); });
}

}  // namespace

// Ordered objects look for each new member among all before it; sorted ones, as this is, don't.
Json json_value(const FreeTable& table) { return nlohmann::json::parse(table.json); }

Json json_value(const std::map<std::string, double>& numbers) {
  Json json = Json::object();
  for (const auto& [name, number] : numbers) json[name] = number;
  return json;
}

Json json_value(const std::map<std::string, std::string>& texts) {
  Json json = Json::object();
  for (const auto& [name, text] : texts) json[name] = text;
  return json;
}

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

bool read_value(const Json& json, bool& value) {
  if (!json.is_boolean()) return false;
  value = json.get<bool>();
  return true;
}

bool read_value(const Json& json, double& value) {
  if (!json.is_number()) return false;
  value = json.get<double>();
  return true;
}

bool read_value(const Json& json, Index& value) {
  // JSON integers above 2^63 - 1 are unsigned and don't fit.
  if (!json.is_number_integer() || (json.is_number_unsigned() && json.get<std::uint64_t>() >> 63)) {
    return false;
  }
  value = json.get<Index>();
  return true;
}

bool read_value(const Json& json, std::string& value) {
  if (!json.is_string()) return false;
  value = json.get<std::string>();
  return true;
}

bool read_value(const Json& json, std::vector<std::string>& value) {
  return read_list<std::string>(json, value, read_value);
}

bool read_value(const Json& json, std::vector<std::vector<double>>& value) {
  if (!json.is_array()) return false;
  value.clear();
  return std::ranges::all_of(json, [&](const Json& row) {
    return read_list<double>(row, value.emplace_back(), read_value);
  });
}

bool read_value(const Json& json, FreeTable& value) {
  value.json = json.dump();
  return json.is_object();
}

bool read_value(const Json& json, std::map<std::string, double>& value) {
  if (!json.is_object()) return false;
  value.clear();
  for (const auto& [name, number] : json.items()) {
    if (!read_value(number, value[name])) return false;
  }
  return true;
}

bool read_value(const Json& json, std::vector<inference::Marginal>& value) {
  return read_list<inference::Marginal>(json, value, read_marginal);
}

void JsonReader::reject_unknown_keys() const {
  for (const auto& [key, value] : json_.items()) {
    if (std::find(known_.begin(), known_.end(), key) == known_.end()) {
      throw InputError(where_ + ": " + unknown_name("key", shortened(key), known_));
    }
  }
}

}  // namespace npdr::pipeline
