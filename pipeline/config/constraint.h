/// Rules for the values of a study's fields: words for people and a test for the readers.
#pragma once

#include <concepts>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/range.h"
#include "core/text.h"

namespace npdr::pipeline {

/// `words` completes "must be ..." and `names` lists the choices when there are only a few. A
/// constraint without a test allows every value of the field's type. Numbers of every type are
/// constrained as double.
template <class T>
struct Constraint {
  std::string words;
  std::function<bool(const T&)> allows;
  std::vector<std::string> names = {};
};

/// Every value of the type.
template <class T>
Constraint<T> anything() {
  return {"", nullptr};
}

Constraint<double> positive();
Constraint<double> between(const Range& range);
Constraint<double> between(double low, double high);
/// `above` is ">" or ">=", `below` "<" or "<=".
Constraint<double> interval(const std::string& above, double low, const std::string& below,
                            double high);
/// A number of things: low to 10^9, far beyond what a study can compute and far from an overflow.
Constraint<double> count_from(double low);
/// A number >= 0.
Constraint<double> not_negative();

Constraint<std::string> one_of(std::vector<std::string> names);
/// A name of the enumeration, or another spelling of it.
template <NamedEnum E>
Constraint<std::string> one_of() {
  Constraint<std::string> constraint = one_of(names_of<E>());
  constraint.allows = [](const std::string& name) { return value_named<E>(name).has_value(); };
  return constraint;
}
/// Text without control characters, 1 to 100 bytes.
Constraint<std::string> label();
/// A label that can name a folder: letters, digits, '_', '-' and '.', not at the start.
Constraint<std::string> folder_name();

/// As many numbers as anybody has names for.
Constraint<std::map<std::string, double>> few_numbers();

/// A path: 1 to 4096 bytes, none of them a control character.
Constraint<std::string> file_path();

/// True when `value` is allowed. Numbers are compared as double.
template <class T, class C>
bool satisfies(const T& value, const Constraint<C>& allowed) {
  if (!allowed.allows) return true;
  if constexpr (std::same_as<T, C>) {
    return allowed.allows(value);
  } else {
    return allowed.allows(static_cast<C>(value));
  }
}
/// A value that is left out is allowed.
template <class T, class C>
bool satisfies(const std::optional<T>& value, const Constraint<C>& allowed) {
  return !value || satisfies(*value, allowed);
}

/// Text for a shell to run: not blank, and without control characters other than line breaks and
/// tabs; at most 65536 bytes.
Constraint<std::string> shell_command();

/// Name that heads a column of a CSV file as it stands: letters, digits, '_', '-' and '.'.
Constraint<std::string> column_name();

/// "a number, > 0": what a field of type `type` must be when a value of another type was found.
template <class C>
std::string type_and_words(const std::string& type, const Constraint<C>& allowed) {
  return allowed.words.empty() ? type : type + ", " + allowed.words;
}

}  // namespace npdr::pipeline
