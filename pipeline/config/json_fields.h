/// The visitors of study_fields.h that write and read JSON. Private to pipeline/config.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/text.h"
#include "pipeline/config/constraint.h"
#include "pipeline/config/field_types.h"
#include "pipeline/config/field_use.h"

namespace npdr::pipeline {

using Json = nlohmann::ordered_json;

template <class T>
Json json_value(const T& value) {
  return value;
}
Json json_value(const FreeTable& table);
Json json_value(const std::map<std::string, double>& numbers);
Json json_value(const std::map<std::string, std::string>& texts);
Json json_value(const std::map<std::string, PublishedFigure>& figures);
Json json_value(const std::vector<inference::Marginal>& prior);

/// Writes fields, defaults included, in the order of the description.
class JsonWriter {
 public:
  /// Writes those whose use `is_kept`; all without one.
  explicit JsonWriter(std::function<bool(const FieldUse&)> is_kept = nullptr)
      : is_kept_(std::move(is_kept)) {}

  template <class T, class C>
  void operator()(const std::string& key, const T& value, const Constraint<C>& /*allowed*/,
                  std::string_view /*doc*/, const FieldUse& use = {}) {
    if (keeps(use)) json_[key] = json_value(value);
  }

  template <class T, class C>
  void operator()(const std::string& key, const std::optional<T>& value,
                  const Constraint<C>& /*allowed*/, std::string_view /*doc*/,
                  const FieldUse& use = {}) {
    if (value && keeps(use)) json_[key] = json_value(*value);
  }

  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body,
             const FieldUse& use = {}) {
    if (!keeps(use)) return;
    JsonWriter members(is_kept_);
    body(members);
    json_[key] = members.json();
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int /*minimum*/,
            std::string_view /*doc*/, const Body& body, const FieldUse& use = {}) {
    if (!keeps(use)) return;
    json_[key] = Json::array();
    for (T& value : values) {
      JsonWriter members(is_kept_);
      body(members, value);
      json_[key].push_back(members.json());
    }
  }

  const Json& json() const { return json_; }

 private:
  bool keeps(const FieldUse& use) const { return !is_kept_ || is_kept_(use); }

  std::function<bool(const FieldUse&)> is_kept_;
  Json json_ = Json::object();
};

bool read_value(const Json& json, bool& value);
bool read_value(const Json& json, double& value);
bool read_value(const Json& json, Index& value);
bool read_value(const Json& json, std::string& value);
bool read_value(const Json& json, std::vector<std::string>& value);
bool read_value(const Json& json, std::vector<std::vector<double>>& value);
bool read_value(const Json& json, FreeTable& value);
bool read_value(const Json& json, std::map<std::string, double>& value);
bool read_value(const Json& json, std::vector<inference::Marginal>& value);

/// Reads the fields of one object; throws InputError at the first that can't be accepted. A missing
/// key keeps its default: it is older than the field.
class JsonReader {
 public:
  JsonReader(const Json& json, std::string where) : json_(json), where_(std::move(where)) {
    if (!json.is_object()) throw InputError(where_ + ": must be a JSON object");
  }

  template <class T, class C>
  void operator()(const std::string& key, T& value, const Constraint<C>& allowed,
                  std::string_view /*doc*/, const FieldUse& /*use*/ = {}) {
    known_.push_back(key);
    const auto found = json_.find(key);
    if (found == json_.end()) return;
    const std::string text = shortened(found->dump());
    if (!read_value(*found, value)) {
      throw InputError(where_ + ": " + must_be(key, text, type_and_words(type_name<T>(), allowed)));
    }
    if (!satisfies(value, allowed)) {
      throw InputError(where_ + ": " + must_be(key, text, allowed.words, allowed.names));
    }
  }

  template <class T, class C>
  void operator()(const std::string& key, std::optional<T>& value, const Constraint<C>& allowed,
                  std::string_view doc, const FieldUse& /*use*/ = {}) {
    T read{};
    (*this)(key, read, allowed, doc);
    if (json_.contains(key)) value = std::move(read);
  }

  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body,
             const FieldUse& /*use*/ = {}) {
    known_.push_back(key);
    const auto found = json_.find(key);
    if (found == json_.end()) return;
    JsonReader members(*found, where_ + ": " + key);
    body(members);
    members.reject_unknown_keys();
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int /*minimum*/,
            std::string_view /*doc*/, const Body& body, const FieldUse& /*use*/ = {}) {
    known_.push_back(key);
    const auto found = json_.find(key);
    if (found == json_.end()) return;
    if (!found->is_array()) throw InputError(where_ + ": " + key + " must be a list of objects");
    for (const Json& element : *found) {
      JsonReader members(element, where_ + ": " + key);
      body(members, values.emplace_back());
      members.reject_unknown_keys();
    }
  }

  void reject_unknown_keys() const;

 private:
  const Json& json_;
  std::string where_;
  std::vector<std::string> known_;
};

}  // namespace npdr::pipeline
