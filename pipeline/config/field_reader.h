/// The visitor of study_fields.h that reads: study files, and parts of studies in artefacts.
/// Private to pipeline/config.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/field_types.h"
#include "pipeline/config/field_use.h"
#include "pipeline/config/reading.h"

namespace npdr::pipeline {

/// Values of a file by their keys, which are sorted: ordered JSON looks for each new key among all
/// before it.
using FieldTree = nlohmann::json;

/// A value that is being read, its dotted path and the reading it belongs to.
struct FieldSlot {
  const FieldTree& json;
  std::string path;
  Reading& reading;
};

/// False when the value is of another type, which the caller says. Tables whose keys are names of
/// the user's own choice report what is wrong inside of them.
bool read_value(const FieldSlot& slot, bool& value);
bool read_value(const FieldSlot& slot, double& value);
bool read_value(const FieldSlot& slot, Index& value);
bool read_value(const FieldSlot& slot, std::uint64_t& value);
bool read_value(const FieldSlot& slot, std::string& value);
/// Of a study file, numbers in tables of tables have the names of both: `a.b = 1` is "a.b".
bool read_value(const FieldSlot& slot, std::map<std::string, double>& value);
bool read_value(const FieldSlot& slot, std::map<std::string, std::string>& value);
bool read_value(const FieldSlot& slot, FreeTable& value);
bool read_value(const FieldSlot& slot, std::map<std::string, PublishedFigure>& value);
/// A study file's table, whose order is that of theta.
bool read_value(const FieldSlot& slot, std::vector<inference::Marginal>& value);

/// Kind and numbers of a distribution, in the first member of a table that is called like one.
bool read_distribution(const FieldSlot& slot, inference::Marginal& marginal);

template <class T>
bool read_value(const FieldSlot& slot, std::vector<T>& values) {
  values.clear();
  const auto read = [&](const FieldTree& element) {
    T value{};
    const bool is_read = read_value({element, slot.path, slot.reading}, value);
    values.push_back(std::move(value));
    return is_read;
  };
  return slot.json.is_array() && std::ranges::all_of(slot.json, read);
}

template <class T>
bool read_value(const FieldSlot& slot, std::optional<T>& value) {
  return read_value(slot, value.emplace());
}

/// Reads the members of one table (nullptr: left out) and reports wrong types, values that aren't
/// allowed, unknown keys, and a missing key whose default isn't allowed either: it has none.
class FieldReader {
 public:
  FieldReader(const FieldTree* table, std::string path, Reading& reading)
      : table_(table), path_(std::move(path)), reading_(reading) {}

  template <class T, class C>
  void operator()(const std::string& key, T& value, const Constraint<C>& allowed,
                  std::string_view /*doc*/, const FieldUse& /*use*/ = {}) {
    const std::string path = below(key);
    const FieldTree* json = look_up(key);
    if (json == nullptr) {
      if (!satisfies(value, allowed)) {
        reading_.fail(path, display(path) + " is missing, must be " +
                                type_and_words(type_name<T>(), allowed));
      }
    } else if (T read{}; !read_value({*json, path, reading_}, read)) {
      fail(path, *json, type_and_words(type_name<T>(), allowed));
    } else if (!satisfies(read, allowed)) {
      fail(path, *json, allowed.words, allowed.names);
    } else {
      value = std::move(read);
    }
  }

  /// A table below this one; `body` describes it.
  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body,
             const FieldUse& /*use*/ = {}) {
    const FieldTree* json = look_up(key);
    if (json != nullptr && !json->is_object()) return fail(below(key), *json, "a table");
    FieldReader fields(json, below(key), reading_);
    body(fields);
    fields.reject_unknown_keys();
  }

  /// A list of tables, [[key]]; `body` describes one element. It may be empty where `minimum` is 0,
  /// and holds at most 1000 of them.
  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int minimum, std::string_view /*doc*/,
            const Body& body, const FieldUse& /*use*/ = {}) {
    for (const auto& [path, element] : elements(key, minimum)) {
      FieldReader fields(element, path, reading_);
      body(fields, values.emplace_back());
      fields.reject_unknown_keys();
    }
  }

  /// Reports the keys of the table that nobody has asked for.
  void reject_unknown_keys();

 private:
  std::string below(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }

  void fail(const std::string& path, const FieldTree& found, const std::string& words,
            const std::vector<std::string>& names = {});

  // Notes down that `key` is known, and where it stands.
  const FieldTree* look_up(const std::string& key);
  // The tables of a list, by path.
  std::vector<std::pair<std::string, const FieldTree*>> elements(const std::string& key,
                                                                 int minimum);

  const FieldTree* table_;
  std::string path_;
  Reading& reading_;
  std::vector<std::string> known_;
};

}  // namespace npdr::pipeline
