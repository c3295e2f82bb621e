/// The visitor of study_fields.h that reads TOML. Private to pipeline/config.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/field_types.h"
#include "pipeline/config/field_use.h"
#include "pipeline/config/toml_values.h"

namespace npdr::pipeline {

/// Reads the members of one table (nullptr: left out) and reports wrong types, values that aren't
/// allowed, and a missing key whose default isn't allowed either: it has none.
class TomlFields {
 public:
  TomlFields(const toml::table* table, std::string path, Reading& reading)
      : table_(table), path_(std::move(path)), reading_(reading) {}

  template <class T, class C>
  void operator()(const std::string& key, T& value, const Constraint<C>& allowed,
                  std::string_view /*doc*/, const FieldUse& /*use*/ = {}) {
    const std::string path = below(key);
    const toml::node* node = look_up(key);
    if (node == nullptr) {
      if (!allows(value, allowed)) {
        reading_.fail(path, display(path) + " is missing, must be " +
                                type_and_words(type_name<T>(), allowed));
      }
    } else if (T read{}; !read_value({*node, path, reading_}, read)) {
      const std::string words = type_and_words(type_name<T>(), allowed);
      reading_.fail(path, must_be(display(path), found_text(*node), words));
    } else if (!allows(read, allowed)) {
      const auto& names = allowed.names;
      reading_.fail(path, must_be(display(path), found_text(*node), allowed.words, names));
    } else {
      value = std::move(read);
    }
  }

  /// A table below this one; `body` describes it.
  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body,
             const FieldUse& /*use*/ = {}) {
    const toml::node* node = look_up(key);
    if (node != nullptr && !node->is_table()) {
      reading_.fail(below(key), must_be(display(below(key)), found_text(*node), "a table"));
      return;
    }
    TomlFields fields(node == nullptr ? nullptr : node->as_table(), below(key), reading_);
    body(fields);
    fields.reject_unknown_keys();
  }

  /// A list of tables, [[key]]; `body` describes one element. It may be empty where `minimum` is 0,
  /// and holds at most 1000 of them.
  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int minimum, std::string_view /*doc*/,
            const Body& body, const FieldUse& /*use*/ = {}) {
    const toml::node* node = look_up(key);
    if (node == nullptr && minimum == 0) return;
    if (node == nullptr || !node->is_array_of_tables()) {
      const std::string tables = "[[" + display(below(key)) + "]] table";
      reading_.fail(below(key), minimum > 0 ? "needs at least one " + tables
                                            : "must be made of " + tables + "s");
      return;
    }
    constexpr std::size_t most = 1000;
    if (const std::size_t count = node->as_array()->size(); count > most) {
      reading_.fail(below(key), display(below(key)) + " is there " + std::to_string(count) +
                                    " times, must be at most " + std::to_string(most));
      return;
    }
    std::size_t i = 0;
    for (const toml::node& element : *node->as_array()) {
      const std::string path = below(key) + "[" + std::to_string(i++) + "]";
      reading_.found(path, place_of(element.source(), reading_.origin()));
      TomlFields fields(element.as_table(), path, reading_);
      body(fields, values.emplace_back());
      fields.reject_unknown_keys();
    }
  }

  /// Reports the keys of the table that nobody has asked for.
  void reject_unknown_keys();

 private:
  template <class T, class C>
  static bool allows(const T& value, const Constraint<C>& allowed) {
    return satisfies(value, allowed);
  }
  template <class T, class C>
  static bool allows(const std::optional<T>& value, const Constraint<C>& allowed) {
    return !value || satisfies(*value, allowed);
  }

  std::string below(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }

  // Notes down that `key` is known, and where it stands.
  const toml::node* look_up(const std::string& key);

  const toml::table* table_;
  std::string path_;
  Reading& reading_;
  std::vector<std::string> known_;
};

}  // namespace npdr::pipeline
