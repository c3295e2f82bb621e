/// The visitor of study_fields.h that changes one field of a study to another allowed value.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/config/reading.h"
#include "pipeline/config/study_fields.h"

namespace npdr::pipeline {

/// Texts and names that a field may have and no rule could make up, by path.
using TextsByPath = std::map<std::string, std::vector<std::string>>;

/// Values other than `value`, allowed or not.
inline std::vector<bool> other_values(bool value) { return {!value}; }
inline std::vector<double> other_values(double value) {
  if (value == 0.0) return {0.1, 1.0};
  return {0.9 * value, 0.5 * value, value + 0.1, value + 1.0};
}
inline std::vector<Index> other_values(Index value) {
  return {value + 1, value + 2, value - 1, 2, 20};
}
inline std::vector<std::uint64_t> other_values(std::uint64_t value) { return {value + 1}; }
inline std::vector<std::vector<std::uint64_t>> other_values(std::vector<std::uint64_t> value) {
  value.push_back(9);
  return {{2, 1}, {1, 2, 3}, value};
}
inline std::vector<std::vector<double>> other_values(std::vector<double> value) {
  for (double& number : value) number *= 0.9;
  return {value, {0.2, 0.3}, {3.0, 0.5}};
}
inline std::vector<std::vector<std::vector<double>>> other_values(
    std::vector<std::vector<double>> value) {
  for (auto& row : value) row = other_values(row).front();
  return {value};
}
inline std::vector<std::map<std::string, double>> other_values(
    std::map<std::string, double> value) {
  for (auto& [name, number] : value) number *= 0.9;
  return {value, {{"pole_mass", 0.02}}, {{"theta", 0.01}}, {{"energy_gain", 21.0}}};
}
inline std::vector<std::map<std::string, std::string>> other_values(
    const std::map<std::string, std::string>& /*value*/) {
  return {{{"pole_mass", "m_p"}}};
}
inline std::vector<std::map<std::string, PublishedFigure>> other_values(
    const std::map<std::string, PublishedFigure>& /*value*/) {
  return {{{"rmse", {0.3, 0.1}}}};
}
inline std::vector<FreeTable> other_values(const FreeTable& /*value*/) { return {{R"({"a":1})"}}; }
inline std::vector<std::vector<inference::Marginal>> other_values(
    std::vector<inference::Marginal> value) {
  for (inference::Marginal& marginal : value) marginal.b *= 0.9;
  return {value};
}

/// Walks a study, and changes its leaf number `leaf` to its candidate number `candidate`.
class FieldChanger {
 public:
  /// What has been found of that leaf.
  struct Found {
    std::size_t leaf, candidate;
    std::size_t next = 0;  ///< number of the leaf that comes next
    std::string path = {};
    FieldUse use = {};
    bool is_changed = false;
  };

  FieldChanger(Found& found, const TextsByPath& texts, std::string prefix = "", FieldUse use = {})
      : found_(found), texts_(texts), prefix_(std::move(prefix)), use_(std::move(use)) {}

  template <class T, class C>
  void operator()(const std::string& key, T& value, const Constraint<C>& allowed,
                  std::string_view /*doc*/, const FieldUse& use = {}) {
    if (!is_wanted(key, use)) return;
    std::vector<T> fitting;
    for (T other : candidates(value, allowed.names)) {
      if (satisfies(other, allowed)) fitting.push_back(std::move(other));
    }
    found_.is_changed = found_.candidate < fitting.size();
    if (found_.is_changed) value = fitting[found_.candidate];
  }

  template <class T, class C>
  void operator()(const std::string& key, std::optional<T>& value, const Constraint<C>& allowed,
                  std::string_view doc, const FieldUse& use = {}) {
    T inner = value.value_or(T{});
    (*this)(key, inner, allowed, doc, use);
    if (found_.is_changed && found_.next == found_.leaf + 1) value = inner;
  }

  template <class Body>
  void table(const std::string& key, std::string_view /*doc*/, const Body& body,
             const FieldUse& use = {}) {
    FieldChanger members(found_, texts_, prefix_ + key + ".", below(use));
    body(members);
  }

  template <class T, class Body>
  void list(const std::string& key, std::vector<T>& values, int /*minimum*/,
            std::string_view /*doc*/, const Body& body, const FieldUse& use = {}) {
    for (T& value : values) {
      FieldChanger members(found_, texts_, prefix_ + key + ".", below(use));
      body(members, value);
    }
  }

 private:
  // Members are used as their table is, unless they say otherwise.
  FieldUse below(FieldUse use) const {
    if (use.affects == Affects::results) use.affects = use_.affects;
    if (use.unused.empty()) use.unused = use_.unused;
    return use;
  }

  bool is_wanted(const std::string& key, const FieldUse& use) {
    if (found_.next++ != found_.leaf) return false;
    found_.path = prefix_ + key;
    found_.use = below(use);
    return true;
  }

  template <class T>
  std::vector<T> candidates(const T& value, const std::vector<std::string>& names) const {
    if constexpr (std::same_as<T, std::string>) {
      if (const auto known = texts_.find(found_.path); known != texts_.end()) return known->second;
      std::vector<std::string> all = names;
      std::erase(all, value);
      if (names.empty()) all = {value + "x", "2"};
      return all;
    } else if constexpr (std::same_as<T, std::vector<std::string>>) {
      if (const auto known = texts_.find(found_.path); known != texts_.end()) {
        return {known->second};
      }
      return {std::vector<std::string>(value.begin(), value.end() - (value.empty() ? 0 : 1))};
    } else {
      return other_values(value);
    }
  }

  Found& found_;
  const TextsByPath& texts_;
  std::string prefix_;
  FieldUse use_;  // of the table
};

}  // namespace npdr::pipeline
