/// The visitor of study_fields.h that writes JSON. Private to pipeline/config.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace npdr::pipeline
