#include "pipeline/config/field_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <tuple>

#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

// Dates and times, which JSON hasn't, are their text as bytes.
std::string date_text(const FieldTree& json) {
  return {json.get_binary().begin(), json.get_binary().end()};
}

// As TOML on one line.
std::string inline_text(const FieldTree& json) {
  if (json.is_string()) return quoted(json.get<std::string>());
  if (json.is_number_float()) return fmt::format("{:#}", json.get<double>());
  if (json.is_binary()) return date_text(json);
  if (!json.is_structured()) return json.dump();
  std::vector<std::string> parts;
  for (const auto& [key, value] : json.items()) {
    parts.push_back((json.is_object() ? key + " = " : "") + inline_text(value));
  }
  return json.is_object() ? "{ " + join(parts) + " }" : "[" + join(parts) + "]";
}

// The slot of a table's member, with its place noted down.
FieldSlot member_slot(const FieldSlot& slot, const std::string& key, const FieldTree& json) {
  const std::string path = slot.path + "." + key;
  slot.reading.found(path);
  return {json, path, slot.reading};
}

// Keys of a table in the order of the file; those of the command line follow in its order.
std::vector<std::string> in_file_order(const FieldSlot& slot) {
  std::vector<std::pair<std::tuple<bool, int, int>, std::string>> keys;
  for (const auto& [key, json] : slot.json.items()) {
    const Place place = slot.reading.source(slot.path + "." + key).key;
    keys.push_back({{place.is_override(), place.line, place.column}, key});
  }
  std::ranges::sort(keys);
  std::vector<std::string> ordered;
  for (const auto& [rank, key] : keys) ordered.push_back(key);
  return ordered;
}

// A distribution is a table with one member that is a list; a table of tables isn't one.
bool has_only_tables(const FieldTree& json) {
  return json.is_object() && !json.empty() && std::ranges::all_of(json, &FieldTree::is_object);
}

// What is wrong with an entry of the prior: an unknown name, as long as that is a name, or unknown
// physical ends.
void reject_marginal(const FieldSlot& slot) {
  std::vector<std::string> known = names_of<Marginal::Kind>();
  known.insert(known.end(), {kPhysical, kLower, kUpper});
  if (slot.json.is_object()) {
    for (const auto& [key, json] : slot.json.items()) {
      if (std::ranges::find(known, key) != known.end() || value_named<Marginal::Kind>(key))
        continue;
      return slot.reading.fail(
          slot.path, slot.reading.source(slot.path + "." + key).key,
          display(slot.path) + ": " + unknown_name("key", shortened(key), known));
    }
    const auto ends = slot.json.find(kPhysical);
    const auto allowed = one_of<inference::PhysicalEnds>();
    if (ends != slot.json.end() &&
        !(ends->is_string() && allowed.allows(ends->get<std::string>()))) {
      return reject(member_slot(slot, kPhysical, *ends), allowed.words, allowed.names);
    }
    for (const char* end : {kLower, kUpper}) {
      const auto given = slot.json.find(end);
      if (given == slot.json.end() || given->is_number()) continue;
      return reject(member_slot(slot, end, *given), "a number", {});
    }
  }
  reject(slot, marginal_words());
}

// `prefix`: the names of the tables around this one, each followed by a point.
void read_marginals(const FieldSlot& slot, const std::string& prefix, std::set<std::string>& names,
                    std::vector<Marginal>& value) {
  for (const std::string& key : in_file_order(slot)) {
    const FieldSlot member = member_slot(slot, key, slot.json.at(key));
    const std::string name = prefix + key;
    if (has_only_tables(member.json)) {
      read_marginals(member, name + ".", names, value);
      continue;
    }
    Marginal marginal;
    marginal.name = name;
    const bool is_one =
        member.json.is_object() && member.json.size() == 1 + num_beside_kind(member.json);
    if (!is_one || !read_distribution(member, marginal)) reject_marginal(member);
    if (!names.insert(name).second) {
      member.reading.fail(member.path, fmt::format("prior: {} is there twice", quoted(name)));
    }
    value.push_back(marginal);
  }
}

void read_numbers(const FieldSlot& slot, const std::string& prefix,
                  std::map<std::string, double>& value) {
  for (const auto& [key, json] : slot.json.items()) {
    const FieldSlot member = member_slot(slot, key, json);
    if (json.is_object() && !json.empty() && !slot.reading.is_of_json()) {
      read_numbers(member, prefix + key + ".", value);
    } else if (double& number = value[prefix + key]; !read_value(member, number)) {
      reject(member, type_name<double>());
    }
  }
}

// As JSON that can be written: dates, infinities and NaN as texts.
FieldTree plain(const FieldTree& json) {
  if (json.is_binary()) return date_text(json);
  if (json.is_number_float() && !std::isfinite(json.get<double>())) {
    const double number = json.get<double>();
    return std::isnan(number) ? "NaN" : number > 0.0 ? "Infinity" : "-Infinity";
  }
  if (!json.is_structured()) return json;
  FieldTree copy(json.type());
  for (const auto& [key, member] : json.items()) {
    json.is_object() ? (void)(copy[key] = plain(member)) : copy.push_back(plain(member));
  }
  return copy;
}

bool is_list_of_tables(const FieldTree& json) {
  return json.is_array() && std::ranges::all_of(json, &FieldTree::is_object);
}

template <class T>
bool read_as(const FieldTree& json, bool is_of_type, T& value) {
  if (is_of_type) value = json.get<T>();
  return is_of_type;
}

}  // namespace

void reject(const FieldSlot& slot, const std::string& words,
            const std::vector<std::string>& names) {
  const std::string found = slot.reading.is_of_json() ? slot.json.dump() : inline_text(slot.json);
  slot.reading.reject(slot.path, shortened(found), words, names);
}

void reject_kind(const FieldSlot& slot, Field::Kind kind, const std::string& words) {
  const bool is_list = slot.json.is_array() && !slot.json.empty() && is_list_of_tables(slot.json);
  const bool is_other = kind == Field::Kind::list ? slot.json.is_object() : is_list;
  if (slot.reading.is_of_json() || kind == Field::Kind::value || !is_other) {
    return kind == Field::Kind::list ? slot.reading.fail(slot.path, words) : reject(slot, words);
  }
  const std::string name = display(slot.path);
  const std::string one = "[" + name + "]", several = "[[" + name + "]]";
  const auto& [right, wrong] = is_list ? std::tie(one, several) : std::tie(several, one);
  slot.reading.fail(slot.path, fmt::format("write {} in place of {}: {}", right, wrong,
                                           is_list ? "there is one such table"
                                                   : "there may be several such tables"));
}

std::size_t num_beside_kind(const FieldTree& json) {
  return static_cast<std::size_t>(std::ranges::count_if(
      std::array{kPhysical, kLower, kUpper}, [&](const char* key) { return json.contains(key); }));
}

bool read_distribution(const FieldSlot& slot, Marginal& marginal) {
  if (const auto given = slot.json.find(kPhysical); given != slot.json.end()) {
    const auto ends = given->is_string()
                          ? value_named<inference::PhysicalEnds>(given->get<std::string>())
                          : std::nullopt;
    if (!ends) return false;
    marginal.physical = *ends;
  }
  for (const auto& [key, end] : {std::pair(kLower, &marginal.from), {kUpper, &marginal.to}}) {
    const auto given = slot.json.find(key);
    if (given != slot.json.end() && !read_value({*given, slot.path, slot.reading}, *end))
      return false;
  }
  for (const auto& [key, numbers] : slot.json.items()) {
    const auto kind = value_named<Marginal::Kind>(key);
    std::vector<double> bounds;
    if (!kind) continue;
    if (!read_value({numbers, slot.path, slot.reading}, bounds) || bounds.size() != 2) return false;
    marginal.kind = *kind;
    marginal.a = bounds[0];
    marginal.b = bounds[1];
    return true;
  }
  return false;
}

bool read_value(const FieldSlot& slot, bool& value) {
  return read_as(slot.json, slot.json.is_boolean(), value);
}

bool read_value(const FieldSlot& slot, double& value) {
  return read_as(slot.json, slot.json.is_number(), value) && std::isfinite(value);
}

bool read_value(const FieldSlot& slot, Index& value) {
  // JSON integers above 2^63 - 1 are unsigned and don't fit.
  const bool fits = !slot.json.is_number_unsigned() || slot.json.get<std::uint64_t>() >> 63 == 0;
  return read_as(slot.json, slot.json.is_number_integer() && fits, value);
}

bool read_value(const FieldSlot& slot, std::uint64_t& value) {
  Index number = 0;
  if (!read_value(slot, number) || number < 0) return false;
  value = static_cast<std::uint64_t>(number);
  return true;
}

bool read_value(const FieldSlot& slot, std::string& value) {
  return read_as(slot.json, slot.json.is_string(), value);
}

bool read_value(const FieldSlot& slot, std::map<std::string, double>& value) {
  value.clear();
  if (slot.json.is_object()) read_numbers(slot, "", value);
  return slot.json.is_object();
}

bool read_value(const FieldSlot& slot, std::map<std::string, std::string>& value) {
  if (!slot.json.is_object()) return false;
  for (const auto& [key, json] : slot.json.items()) {
    const FieldSlot member = member_slot(slot, key, json);
    if (!read_value(member, value[key])) reject(member, "a text");
  }
  return true;
}

bool read_value(const FieldSlot& slot, FreeTable& value) {
  value.json = plain(slot.json).dump();
  return slot.json.is_object();
}

bool read_value(const FieldSlot& slot, std::map<std::string, PublishedFigure>& value) {
  if (!slot.json.is_object()) return false;
  for (const auto& [key, json] : slot.json.items()) {
    const FieldSlot member = member_slot(slot, key, json);
    if (!json.is_object()) {
      reject(member, "a table, { mean = 0.263, std = 0.004 }");
      continue;
    }
    FieldReader(&json, member.path, slot.reading).read([&](auto& t) { describe(t, value[key]); });
  }
  return true;
}

bool read_value(const FieldSlot& slot, std::vector<Marginal>& value) {
  if (!slot.json.is_object()) return false;
  std::set<std::string> names;
  read_marginals(slot, "", names, value);
  return true;
}

std::pair<std::string, const FieldTree*> FieldReader::look_up(const std::string& key) {
  const std::string path = below(key);
  if (table_ == nullptr || !table_->contains(key)) return {path, nullptr};
  reading_.found(path);
  return {path, &table_->at(key)};
}

std::size_t FieldReader::count_tables(const std::string& path, const FieldTree* json, int minimum) {
  if (json == nullptr && minimum == 0) return 0;
  const bool may_be_empty = reading_.is_of_json();  // TOML has no empty list of tables
  if (json == nullptr || !is_list_of_tables(*json) || (json->empty() && !may_be_empty)) {
    const std::string tables = "[[" + display(path) + "]] table";
    reject_kind({json == nullptr ? FieldTree() : *json, path, reading_}, Field::Kind::list,
                minimum > 0 ? "needs at least one " + tables : "must be made of " + tables + "s");
    return 0;
  }
  constexpr std::size_t most = 1000;
  if (json->size() <= most) return json->size();
  reading_.fail(path, fmt::format("{} is there {} times, must be at most {}", display(path),
                                  json->size(), most));
  return 0;
}

void FieldReader::reject_unknown_keys() {
  if (table_ == nullptr) return;
  std::vector<std::string> known;
  for (const Field& field : fields_) known.push_back(field.key);
  for (const auto& [key, json] : table_->items()) {
    if (std::ranges::find(known, key) != known.end()) continue;
    const std::string where = path_.empty() ? "" : display(path_) + ": ";
    reading_.fail(below(key), reading_.source(below(key)).key,
                  where + unknown_name("key", shortened(key), known));
  }
}

}  // namespace npdr::pipeline
