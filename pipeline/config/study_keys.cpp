#include "pipeline/config/study_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <regex>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/json_fields.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {
namespace {

// Values of fields are written in TOML as in JSON, but for tables, and a blank in lists.
std::string toml_text(const Json& value) {
  if (!value.is_array()) return value.dump();
  std::vector<std::string> elements;
  for (const Json& element : value) elements.push_back(element.dump());
  return "[" + join(elements) + "]";
}

template <class T, class C>
std::string default_text(const T& value, const Constraint<C>& allowed) {
  return satisfies(value, allowed) ? toml_text(json_value(value)) : "required";
}

template <class T, class C>
std::string default_text(const std::optional<T>& /*value*/, const Constraint<C>& /*allowed*/) {
  return "";
}

struct StudyDescription {
  std::vector<StudyTable> tables;
  std::vector<StudyKey> keys;
};

// The visitor that writes down what the others read and write.
class KeyLister {
 public:
  KeyLister(std::string prefix, StudyDescription& all) : prefix_(std::move(prefix)), all_(all) {}

  template <class T, class C>
  void operator()(const std::string& key, const T& value, const Constraint<C>& allowed,
                  std::string_view doc, const FieldUse& /*use*/ = {}) {
    all_.keys.push_back({prefix_ + key, type_name<T>(), default_text(value, allowed), allowed.words,
                         allowed.names, std::string(doc)});
  }

  template <class Body>
  void table(const std::string& key, std::string_view doc, const Body& body,
             const FieldUse& /*use*/ = {}) {
    KeyLister members = below(key, doc);
    body(members);
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& /*values*/, int /*minimum*/,
            std::string_view doc, const Body& body, const FieldUse& /*use*/ = {}) {
    KeyLister members = below(key, doc);
    T element;
    body(members, element);
  }

 private:
  KeyLister below(const std::string& key, std::string_view doc) {
    all_.tables.push_back({prefix_ + key, std::string(doc)});
    return {prefix_ + key + ".", all_};
  }

  std::string prefix_;
  StudyDescription& all_;
};

StudyDescription description() {
  StudyDescription all;
  Study defaults;
  KeyLister lister("", all);
  describe(lister, defaults);
  return all;
}

// The table that a key stands in; "" for one that stands in none.
std::string table_of(const StudyKey& key) {
  return key.path.substr(0, key.path.size() - std::min(key.path.size(), key.name().size() + 1));
}

// "an integer" as "integer", "a list of finite numbers" as "list of numbers".
std::string bare_type(const std::string& type) {
  static const std::regex article("^an? |finite ");
  return std::regex_replace(type, article, "");
}

std::string code(const std::string& text) { return "`" + text + "`"; }

// A text with its "quoted" words as code.
std::string with_code(const std::string& text) {
  static const std::regex word("\"[^\"]*\"");
  return std::regex_replace(text, word, "`$&`");
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

std::vector<StudyTable> study_tables() { return description().tables; }

std::vector<StudyKey> study_keys() { return description().keys; }

std::vector<StudyKey> keys_of_table(const std::string& table) {
  std::vector<StudyKey> keys = study_keys();
  std::erase_if(keys, [&](const StudyKey& key) { return table_of(key) != table; });
  return keys;
}

std::string keys_markdown(const std::string& table) {
  const std::vector<StudyKey> keys = keys_of_table(table);
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
