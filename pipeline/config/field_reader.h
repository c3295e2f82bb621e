/// The visitor of study_fields.h that reads study files, and parts of studies in artefacts, and
/// lists the fields. Private to pipeline/config.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "pipeline/config/constraint.h"
#include "pipeline/config/reading.h"
#include "pipeline/config/study_json.h"

namespace npdr::pipeline {

/// Values of a file by their keys, which are sorted: ordered JSON looks for each new key among all
/// before it.
using FieldTree = nlohmann::json;

/// Parses a study's text, whose origin is the reading's, and sets values of it (study_reader.h).
/// Dates and times are binary values that hold their text. Where keys stand, and problems of
/// overrides, go to `reading`. Throws InputError with the position of a syntax error.
FieldTree read_toml(std::string_view text, const std::vector<std::string>& overrides,
                    Reading& reading);

/// "an integer", for a null pointer to the type.
inline const char* type_of(const bool*) { return "true or false"; }
inline const char* type_of(const double*) { return "a finite number"; }
inline const char* type_of(const Index*) { return "an integer"; }
inline const char* type_of(const std::uint64_t*) { return "an integer"; }
inline const char* type_of(const std::string*) { return "text"; }
inline const char* type_of(const std::vector<std::string>*) { return "a list of texts"; }
inline const char* type_of(const std::vector<std::uint64_t>*) { return "a list of integers"; }
inline const char* type_of(const std::vector<double>*) { return "a list of finite numbers"; }
inline const char* type_of(const std::vector<std::vector<double>>*) {
  return "a list of lists of finite numbers";
}
inline const char* type_of(const FreeTable*) { return "a table"; }
inline const char* type_of(const std::map<std::string, double>*) {
  return "a table of finite numbers";
}
inline const char* type_of(const std::map<std::string, std::string>*) { return "a table of texts"; }
inline const char* type_of(const std::map<std::string, PublishedFigure>*) {
  return "a table of { mean, std }";
}
inline const char* type_of(const std::vector<inference::Marginal>*) {
  return "a table of distributions";
}
template <class T>
const char* type_of(const std::optional<T>*) {
  return type_of(static_cast<const T*>(nullptr));
}

/// "an integer".
template <class T>
std::string type_name() {
  return type_of(static_cast<const T*>(nullptr));
}

/// "a number, > 0": what a field of type T must be when a value of another type was found.
template <class T, class C>
std::string type_and_words(const Constraint<C>& allowed) {
  return type_name<T>() + (allowed.words.empty() ? "" : ", " + allowed.words);
}

/// Whether a field of type T is a table of a study file.
template <class T>
inline constexpr bool kIsTable = std::is_same_v<T, FreeTable> ||
                                 std::is_same_v<T, std::vector<inference::Marginal>> || requires {
  typename T::mapped_type;
};
template <class T>
inline constexpr bool kIsTable<std::optional<T>> = kIsTable<T>;

/// A value that is being read, its dotted path and the reading it belongs to.
struct FieldSlot {
  const FieldTree& json;
  std::string path;
  Reading& reading;
};

/// Adds `path = value, must be words` to the problems of the reading.
void reject(const FieldSlot& slot, const std::string& words,
            const std::vector<std::string>& names = {});

/// The same of a value that isn't of a field's kind: where it is a table in place of a list of
/// tables, or the other way round, how many brackets its header needs.
void reject_kind(const FieldSlot& slot, Field::Kind kind, const std::string& words);

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

/// As artefacts store a value.
template <class T>
nlohmann::ordered_json json_value(const T& value) {
  return value;
}
nlohmann::ordered_json json_value(const FreeTable& table);
nlohmann::ordered_json json_value(const std::map<std::string, PublishedFigure>& figures);
nlohmann::ordered_json json_value(const std::vector<inference::Marginal>& prior);
template <class T>
nlohmann::ordered_json json_value(const std::optional<T>& value) {
  return value ? json_value(*value) : nlohmann::ordered_json();
}

/// Keys beside a distribution's kind: Marginal::physical, `from` and `to`.
inline constexpr const char* kPhysical = "physical";
inline constexpr const char* kLower = "lower";
inline constexpr const char* kUpper = "upper";
/// How many of them it has.
std::size_t num_beside_kind(const FieldTree& json);

/// Kind and numbers of a distribution, in the first member of a table that is called like one, and
/// what stands beside it.
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
                  std::string_view doc, const FieldUse& use = {}) {
    const auto [path, json] = look_up(key);
    bool is_allowed = satisfies(value, allowed);
    if (json == nullptr) {
      if (!is_allowed) {
        reading_.fail(path, display(path) + " is missing, must be " + type_and_words<T>(allowed));
      }
    } else if (T read{}; !read_value({*json, path, reading_}, read)) {
      reject_kind({*json, path, reading_}, kIsTable<T> ? Field::Kind::table : Field::Kind::value,
                  type_and_words<T>(allowed));
    } else if (!satisfies(read, allowed)) {
      reject({*json, path, reading_}, allowed.words, allowed.names);
    } else {
      value = std::move(read);
      is_allowed = true;
    }
    fields_.push_back({Field::Kind::value, path, key, std::string(doc), use, json_value(value),
                       is_allowed, type_name<T>(), allowed.words, allowed.names});
  }

  /// A table below this one; `body` describes it.
  template <class Body>
  void table(const std::string& key, std::string_view doc, const Body& body,
             const FieldUse& use = {}) {
    const auto [path, json] = look_up(key);
    fields_.push_back({Field::Kind::table, path, key, std::string(doc), use});
    if (json != nullptr && !json->is_object()) {
      return reject_kind({*json, path, reading_}, Field::Kind::table, "a table");
    }
    fields_.back().members.push_back(FieldReader(json, path, reading_).read(body));
  }

  /// A list of tables, [[key]]; `body` describes one element. It may be empty where `minimum` is 0,
  /// and holds at most 1000 of them. Of a left-out table, the elements of `values` are listed.
  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int minimum, std::string_view doc,
            const Body& body, const FieldUse& use = {}) {
    const auto [path, json] = look_up(key);
    if (table_ != nullptr) values.resize(count_tables(path, json, minimum));
    Field field = {Field::Kind::list, path, key, std::string(doc), use};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::string element = path + "[" + std::to_string(i) + "]";
      if (json != nullptr) reading_.found(element);
      FieldReader fields(json == nullptr ? nullptr : &(*json)[i], element, reading_);
      field.members.push_back(fields.read([&](auto& t) { body(t, values[i]); }));
    }
    fields_.push_back(std::move(field));
  }

  /// Fields that `body` describes; reports all other keys of the table.
  template <class Body>
  Fields read(const Body& body) {
    body(*this);
    reject_unknown_keys();
    return std::move(fields_);
  }

 private:
  std::string below(const std::string& key) const {
    return path_.empty() ? key : path_ + "." + key;
  }

  // The path of `key`, and its value, if any, whose place is noted down.
  std::pair<std::string, const FieldTree*> look_up(const std::string& key);
  std::size_t count_tables(const std::string& path, const FieldTree* json, int minimum);
  void reject_unknown_keys();

  const FieldTree* table_;
  std::string path_;
  Reading& reading_;
  Fields fields_;
};

}  // namespace npdr::pipeline
