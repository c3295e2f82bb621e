#include "pipeline/config/study_keys.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/field_list.h"

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

struct StudyDescription {
  std::vector<StudyTable> tables;
  std::vector<StudyKey> keys;
};

void add_keys(const Fields& fields, const std::string& prefix, StudyDescription& all) {
  for (const Field& field : fields) {
    const std::string path = prefix + field.key;
    if (field.kind == Field::Kind::value) {
      all.keys.push_back(
          {path, field.type, default_text(field), field.allowed, field.names, field.doc});
    } else {
      all.tables.push_back({path, field.doc});
      add_keys(field.members.front(), path + ".", all);
    }
  }
}

StudyDescription description() {
  StudyDescription all;
  add_keys(fields_of(study_with_lists()), "", all);
  return all;
}

// The table that a key stands in; "" for one that stands in none.
std::string table_of(const StudyKey& key) {
  return key.path.substr(0, key.path.size() - std::min(key.path.size(), key.name().size() + 1));
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

std::string default_cell(const StudyKey& key) {
  const bool is_value = !key.default_value.empty() && key.default_value != "required";
  return is_value ? code(key.default_value) : key.default_value;
}

std::string allowed_cell(const StudyKey& key) {
  if (key.names.empty()) return key.allowed;
  return code(join(key.names, "`, `"));
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

std::vector<StudyTable> study_tables() { return description().tables; }

std::vector<StudyKey> study_keys() { return description().keys; }

std::string keys_markdown(const std::string& table) {
  std::vector<StudyKey> keys = study_keys();
  std::erase_if(keys, [&](const StudyKey& key) { return table_of(key) != table; });
  if (keys.empty()) {
    std::vector<std::string> tables;
    for (const StudyTable& known : study_tables()) tables.push_back(known.path);
    throw InputError(unknown_name("table", table, tables));
  }
  std::string text = "| key | type | default | allowed | meaning |\n|---|---|---|---|---|\n";
  for (const StudyKey& key : keys) {
    text += fmt::format("| {} | {} | {} | {} | {} |\n", code(key.name()), bare_type(key.type),
                        default_cell(key), allowed_cell(key), with_code(key.doc));
  }
  return text;
}

std::vector<std::string> method_tables() {
  const std::string begin = "method.";
  std::vector<std::string> names;
  for (const StudyTable& table : study_tables()) {
    if (table.path.starts_with(begin)) names.push_back(table.path.substr(begin.size()));
  }
  names.emplace_back("published");
  return names;
}

}  // namespace npdr::pipeline
