#include "pipeline/config/toml_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "pipeline/config/constraint.h"
#include "pipeline/config/field_types.h"
#include "pipeline/config/study_fields.h"
#include "pipeline/config/toml_fields.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

template <class T>
bool read_list(const TomlSlot& slot, std::vector<T>& values) {
  const toml::array* array = slot.node.as_array();
  if (array == nullptr) return false;
  values.clear();
  for (const toml::node& element : *array) {
    if (!read_value({element, slot.path, slot.reading}, values.emplace_back())) return false;
  }
  return true;
}

// Members of a table in the order of the file; those of the command line follow in its order.
std::vector<std::pair<const toml::key*, const toml::node*>> in_file_order(const toml::table& table,
                                                                          const Reading& reading) {
  std::vector<std::pair<const toml::key*, const toml::node*>> members;
  for (auto&& [key, node] : table) members.emplace_back(&key, &node);
  const auto rank = [&](const toml::key* key) {
    const toml::source_region& source = key->source();
    return std::tuple(is_override(place_of(source, reading.origin())), source.begin.line,
                      source.begin.column);
  };
  std::stable_sort(members.begin(), members.end(),
                   [&](const auto& a, const auto& b) { return rank(a.first) < rank(b.first); });
  return members;
}

// The slot of a table's member, with its place noted down.
TomlSlot member_slot(const TomlSlot& slot, const toml::key& key, const toml::node& node) {
  const std::string path = slot.path + "." + std::string(key.str());
  slot.reading.found(path, place_of(node.source(), slot.reading.origin()));
  return {node, path, slot.reading};
}

void fail_type(const TomlSlot& slot, const std::string& words) {
  slot.reading.fail(slot.path, must_be(display(slot.path), found_text(slot.node), words));
}

// toml++'s own formatter prints every digit of a double.
std::string inline_text(const toml::node& node) {
  if (node.is_string()) return quoted(node.as_string()->get());
  if (node.is_floating_point()) return fmt::format("{:#}", node.as_floating_point()->get());
  std::vector<std::string> parts;
  if (const toml::array* array = node.as_array()) {
    for (const toml::node& element : *array) parts.push_back(inline_text(element));
    return fmt::format("[{}]", join(parts));
  }
  if (const toml::table* table = node.as_table()) {
    for (auto&& [key, value] : *table) {
      parts.push_back(fmt::format("{} = {}", key.str(), inline_text(value)));
    }
    return fmt::format("{{ {} }}", join(parts));
  }
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

bool read_marginal(const TomlSlot& slot, Marginal& marginal) {
  const toml::table* table = slot.node.as_table();
  if (table == nullptr || table->size() != 1) return false;
  const std::string kind(table->begin()->first.str());
  const auto known = value_named<Marginal::Kind>(kind);
  std::vector<double> bounds;
  if (!known || !read_list({table->begin()->second, slot.path, slot.reading}, bounds)) return false;
  if (bounds.size() != 2) return false;
  marginal.kind = *known;
  marginal.a = bounds[0];
  marginal.b = bounds[1];
  return true;
}

// A distribution is a table with one member that is a list; a table of tables isn't one.
bool has_only_tables(const toml::node& node) {
  const toml::table* table = node.as_table();
  return table != nullptr && !table->empty() &&
         std::ranges::all_of(*table, [](auto&& member) { return member.second.is_table(); });
}

// `prefix`: the names of the tables around this one, each followed by a point.
void read_marginals(const TomlSlot& slot, const std::string& prefix, std::set<std::string>& names,
                    std::vector<Marginal>& value) {
  for (const auto& [key, node] : in_file_order(*slot.node.as_table(), slot.reading)) {
    const TomlSlot member = member_slot(slot, *key, *node);
    const std::string name = prefix + std::string(key->str());
    if (has_only_tables(*node)) {
      read_marginals(member, name + ".", names, value);
      continue;
    }
    Marginal marginal;
    marginal.name = name;
    if (!read_marginal(member, marginal)) fail_type(member, marginal_words());
    if (!names.insert(name).second) {
      member.reading.fail(member.path, fmt::format("prior: {} is there twice", quoted(name)));
    }
    value.push_back(marginal);
  }
}

void read_numbers(const TomlSlot& slot, const std::string& prefix,
                  std::map<std::string, double>& value) {
  for (auto&& [key, node] : *slot.node.as_table()) {
    const TomlSlot member = member_slot(slot, key, node);
    const std::string name = prefix + std::string(key.str());
    if (node.is_table() && !node.as_table()->empty()) {
      read_numbers(member, name + ".", value);
      continue;
    }
    double number = 0.0;
    if (!read_value(member, number)) fail_type(member, type_name<double>());
    value[name] = number;
  }
}

}  // namespace

bool read_value(const TomlSlot& slot, bool& value) {
  if (!slot.node.is_boolean()) return false;
  value = slot.node.as_boolean()->get();
  return true;
}

bool read_value(const TomlSlot& slot, double& value) {
  if (!slot.node.is_number()) return false;
  value = *slot.node.value<double>();
  return std::isfinite(value);
}

bool read_value(const TomlSlot& slot, Index& value) {
  if (!slot.node.is_integer()) return false;
  value = slot.node.as_integer()->get();
  return true;
}

bool read_value(const TomlSlot& slot, std::uint64_t& value) {
  if (!slot.node.is_integer() || slot.node.as_integer()->get() < 0) return false;
  value = static_cast<std::uint64_t>(slot.node.as_integer()->get());
  return true;
}

bool read_value(const TomlSlot& slot, std::string& value) {
  if (!slot.node.is_string()) return false;
  value = slot.node.as_string()->get();
  return true;
}

bool read_value(const TomlSlot& slot, std::vector<std::string>& value) {
  return read_list(slot, value);
}

bool read_value(const TomlSlot& slot, std::vector<std::uint64_t>& value) {
  return read_list(slot, value);
}

bool read_value(const TomlSlot& slot, std::vector<double>& value) { return read_list(slot, value); }

bool read_value(const TomlSlot& slot, std::vector<std::vector<double>>& value) {
  return read_list(slot, value);
}

bool read_value(const TomlSlot& slot, std::map<std::string, double>& value) {
  if (!slot.node.is_table()) return false;
  read_numbers(slot, "", value);
  return true;
}

bool read_value(const TomlSlot& slot, std::map<std::string, std::string>& value) {
  const toml::table* table = slot.node.as_table();
  if (table == nullptr) return false;
  for (auto&& [key, node] : *table) {
    const TomlSlot member = member_slot(slot, key, node);
    if (!read_value(member, value[std::string(key.str())])) fail_type(member, "a text");
  }
  return true;
}

bool read_value(const TomlSlot& slot, FreeTable& value) {
  if (!slot.node.is_table()) return false;
  std::ostringstream text;
  text << toml::json_formatter(*slot.node.as_table());
  // Parsed and written again, so that the text doesn't depend on how the study file looks.
  value.json = nlohmann::json::parse(text.str()).dump();
  return true;
}

bool read_value(const TomlSlot& slot, std::map<std::string, PublishedFigure>& value) {
  const toml::table* table = slot.node.as_table();
  if (table == nullptr) return false;
  for (auto&& [key, node] : *table) {
    const TomlSlot member = member_slot(slot, key, node);
    if (!node.is_table()) {
      fail_type(member, "a table, { mean = 0.263, std = 0.004 }");
      continue;
    }
    TomlFields fields(node.as_table(), member.path, slot.reading);
    describe(fields, value[std::string(key.str())]);
    fields.reject_unknown_keys();
  }
  return true;
}

bool read_value(const TomlSlot& slot, std::vector<Marginal>& value) {
  if (!slot.node.is_table()) return false;
  std::set<std::string> names;
  read_marginals(slot, "", names, value);
  return true;
}

std::string found_text(const toml::node& node) { return shortened(inline_text(node)); }

}  // namespace npdr::pipeline
