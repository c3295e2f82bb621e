/// Rules for the values of a study's fields: words for people and a test for the readers.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/constants.h"
#include "core/enum_names.h"
#include "core/range.h"
#include "inference/prior.h"

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

/// True when `value` is allowed.
template <class T, class C>
bool satisfies(const T& value, const Constraint<C>& allowed) {
  return !allowed.allows || allowed.allows(static_cast<const C&>(value));
}
/// A value that is left out is allowed.
template <class T, class C>
bool satisfies(const std::optional<T>& value, const Constraint<C>& allowed) {
  return !value || satisfies(*value, allowed);
}

/// Every value of the type.
template <class T>
Constraint<T> anything() {
  return {"", nullptr};
}

/// The widest layer of a network, and the most layers, transforms or components: far beyond what
/// trains, and a network of a hostile file still fits in memory.
inline constexpr double kMaxWidth = 4096;
inline constexpr double kMaxLayers = 128;
/// The most rollouts, steps or channels of a posterior file: their product fits into an integer.
inline constexpr double kMaxSeries = 1e6;
/// Parameters that a prior may have.
inline constexpr std::size_t kMostParameters = 1000;

enum class End { open, closed };  ///< of an interval: whether it belongs to it
/// The words leave out an infinite upper end.
Constraint<double> interval(End lower, double low, double high, End upper);
inline Constraint<double> between(double low, double high) {
  return interval(End::closed, low, high, End::closed);
}
inline Constraint<double> between(const Range& range) { return between(range.low, range.high); }
inline Constraint<double> above(double low) {
  return interval(End::open, low, kInfinity, End::closed);
}
inline Constraint<double> positive() { return above(0.0); }
inline Constraint<double> not_negative() { return between(0.0, kInfinity); }
/// A number of things: low to 10^9, far beyond what a study can compute and far from an overflow.
Constraint<double> count_from(double low);
/// States of a smoother's window: odd, 5 to 1001.
Constraint<double> window_constraint();
/// A number of folds, or none.
Constraint<double> folds_constraint();

/// [low, high].
Constraint<std::vector<double>> range_constraint();
Constraint<std::vector<double>> ascending();
/// [median, deviation] of noise, the median above `low` and below `high`, the deviation > 0.
Constraint<std::vector<double>> noise_prior(double low, const std::string& name,
                                            double high = kInfinity);
Constraint<std::vector<std::uint64_t>> seeds_constraint();
Constraint<std::vector<std::uint64_t>> rollouts_constraint();
Constraint<std::vector<std::uint64_t>> shape_constraint();
Constraint<std::vector<inference::Marginal>> prior_constraint();
/// As many numbers as anybody has names for.
Constraint<std::map<std::string, double>> few_numbers();

Constraint<std::string> one_of(std::vector<std::string> names);
/// A name of the enumeration, or another spelling of it.
template <NamedEnum E>
Constraint<std::string> one_of() {
  Constraint<std::string> constraint = one_of(names_of<E>());
  constraint.allows = [](const std::string& name) { return value_named<E>(name).has_value(); };
  return constraint;
}
/// `fewest`: 0 or 1.
Constraint<std::vector<std::string>> distinct_of(const std::vector<std::string>& known, int fewest);

/// Text without control characters, 1 to 100 bytes.
Constraint<std::string> label();
/// A label that can name a folder: letters, digits, '_', '-' and '.', not at the start.
Constraint<std::string> folder_name();
/// Name that heads a column of a CSV file as it stands: letters, digits, '_', '-' and '.'.
Constraint<std::string> column_name();
/// A path: 1 to 4096 bytes, none of them a control character.
Constraint<std::string> file_path();
/// Text for a shell to run: not blank, and without control characters other than line breaks and
/// tabs; at most 65536 bytes.
Constraint<std::string> shell_command();
Constraint<std::vector<std::string>> shell_lines();

/// Memory as Slurm takes it: "2G"; "" for none.
Constraint<std::string> memory_constraint();
/// Time as Slurm takes it: "90", "01:30:00", "1-12"; "" for none.
Constraint<std::string> time_constraint();
/// [s] of such a time: "90" (minutes), "MM:SS", "HH:MM:SS", "D-HH[:MM[:SS]]"; none for "" and for
/// other texts.
std::optional<double> seconds_of(const std::string& time);
/// Value behind the = of a batch system's option: one word, or nothing.
Constraint<std::string> option_value();
/// Lines such as "--qos=long".
Constraint<std::vector<std::string>> options_constraint();

/// "{ uniform = [low, high] }, ...": what a prior's entry must be.
std::string marginal_words();

/// A field (study_fields.h) that holds one value of an enumeration: its name to every visitor.
template <class Fields, NamedEnum E, class... Use>
void choice(Fields& f, const char* key, E& value, std::string_view doc, const Use&... use) {
  std::string name = name_of(value);
  f(key, name, one_of<E>(), doc, use...);
  value = parse_enum<E>(key, name);
}

/// A field that holds several of them, each once; `fewest`: 0 or 1.
template <class Fields, NamedEnum E>
void choices(Fields& f, const char* key, std::vector<E>& values, int fewest, const char* doc) {
  std::vector<std::string> names = to_names(values);
  f(key, names, distinct_of(names_of<E>(), fewest), doc);
  values.clear();
  for (const std::string& name : names) values.push_back(parse_enum<E>(key, name));
}

}  // namespace npdr::pipeline
