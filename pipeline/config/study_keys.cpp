#include "pipeline/config/study_keys.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

namespace {

// Values of fields are written in TOML as in JSON, but for tables, and a blank in lists.
std::string toml_text(const Json& value) {
  if (!value.is_array()) return value.dump();
  std::vector<std::string> elements;
  for (const Json& element : value) elements.push_back(element.dump());
  return "[" + join(elements) + "]";
}

// Each table comes before its members.
void add_fields(const Fields& fields, Fields& all) {
  for (const Field& field : fields) {
    all.push_back(field);
    all.back().path = display(field.path);
    if (!field.members.empty()) add_fields(field.members.front(), all);
  }
}

Fields all_fields() {
  Fields all;
  add_fields(fields_of(study_with_lists()), all);
  return all;
}

// "an integer" as "integer", "a list of finite numbers" as "list of numbers".
std::string bare_type(const std::string& type) {
  const std::size_t article = type.starts_with("an ") ? 3 : type.starts_with("a ") ? 2 : 0;
  return replaced_all(type.substr(article), "finite ", "");
}

std::string code(const std::string& text) { return "`" + text + "`"; }

// A text with its "quoted" words as code.
std::string with_code(const std::string& text) {
  std::string marked;
  bool is_inside = false;
  for (const char c : text) {
    marked += c != '"' ? std::string(1, c) : is_inside ? "\"`" : "`\"";
    is_inside ^= c == '"';
  }
  return marked;
}

std::string default_cell(const Field& key) {
  const std::string text = default_text(key);
  return text.empty() || text == "required" ? text : code(text);
}

std::string allowed_cell(const Field& key) {
  return key.names.empty() ? key.allowed : code(join(key.names, "`, `"));
}

}  // namespace

Study study_with_lists() {
  Study study;
  study.methods.emplace_back();
  study.references.emplace_back();
  study.external.parameters.emplace_back();
  return study;
}

std::string default_text(const Field& field) {
  if (field.value.is_null()) return "";
  return field.is_allowed ? toml_text(field.value) : "required";
}

Fields study_keys() {
  Fields keys = all_fields();
  std::erase_if(keys, [](const Field& field) { return field.kind != Field::Kind::value; });
  return keys;
}

std::vector<std::string> study_tables() {
  std::vector<std::string> tables;
  for (const Field& field : all_fields()) {
    if (field.kind != Field::Kind::value) tables.push_back(field.path);
  }
  return tables;
}

std::string keys_markdown(const std::string& table) {
  const std::string prefix = table.empty() ? "" : table + ".";
  Fields keys = study_keys();
  std::erase_if(keys, [&](const Field& key) { return key.path != prefix + key.key; });
  if (keys.empty()) throw InputError(unknown_name("table", table, study_tables()));
  std::string text = "| key | type | default | allowed | meaning |\n|---|---|---|---|---|\n";
  for (const Field& key : keys) {
    text += fmt::format("| {} | {} | {} | {} | {} |\n", code(key.key), bare_type(key.type),
                        default_cell(key), allowed_cell(key), with_code(key.doc));
  }
  return text;
}

std::vector<std::string> method_tables() {
  const std::string begin = "method.";
  std::vector<std::string> names;
  for (const std::string& table : study_tables()) {
    if (table.starts_with(begin)) names.push_back(table.substr(begin.size()));
  }
  names.emplace_back("published");
  return names;
}

}  // namespace npdr::pipeline
