/// Rules between the settings of a study, and between them and its simulator. Private to
/// pipeline/config.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/text.h"
#include "pipeline/config/study_json.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Checks a study whose fields have been read one by one, and takes the prior's units from the
/// simulator. Problems go to `reading`; a field that already has one isn't checked against others.
void check_study(Study& study, Reading& reading);

/// Helpers that the checks of the parts share. Paths are those of the reading, such as
/// "method[0].training"; messages show them without positions.
class Checker {
 public:
  /// `info`: of the study's simulator; nullptr where that isn't known.
  Checker(const Study& study, const sim::SimulatorInfo* info, Reading& reading)
      : study_(study), info_(info), reading_(reading) {}

 protected:
  void fail(const std::string& path, const std::string& message) { reading_.fail(path, message); }

  /// Adds `path = found, must be words` unless `is_allowed`, where nothing is wrong with `path` and
  /// `others`.
  template <class T>
  bool require(const std::string& path, const T& found, bool is_allowed, const std::string& words,
               std::initializer_list<std::string> others = {}) {
    const auto is_good = [&](const std::string& other) { return reading_.good(other); };
    if (is_allowed || !is_good(path) || !std::ranges::all_of(others, is_good)) return is_allowed;
    reading_.reject(path, found_words(found), words);
    return false;
  }

  /// Adds `path is missing, must be words` unless `is_there`.
  void require_there(const std::string& path, bool is_there, const std::string& words);

  /// Adds a problem of the table `path` unless it has one of two keys, given as `key = value`.
  bool require_one_of(const std::string& path, bool has_first, const std::string& first,
                      bool has_second, const std::string& second);

  /// Adds `path must be left out: why` for those that are there.
  void must_be_left_out(std::initializer_list<std::string> paths, const std::string& why);
  /// The same. Of those that --set may give, only where the file has them.
  void must_be_left_out(const std::vector<UnusedField>& fields);

  /// Whether a path stands in the study file; one of --set may be meant for other methods.
  bool is_in_file(const std::string& path) const;

  /// Whether `name` is one of `known`; adds `where: unknown kind 'name'; ...` at `path` when not.
  bool require_known(const std::string& path, const std::string& where, const std::string& kind,
                     const std::string& name, const std::vector<std::string>& known);

  /// The simulator's parameter of that name; nullptr, and the problem noted down as above, when it
  /// has none.
  const sim::Parameter* find_parameter(const std::string& path, const std::string& where,
                                       const std::string& name);

  /// Fails for a value outside of the parameter's limits.
  void check_value(const std::string& path, const sim::Parameter& parameter, double value);
  /// Fails for names that aren't parameters of the simulator, where that is known, and such values.
  /// True where there are none.
  bool check_values(const std::string& path, const std::map<std::string, double>& values);

  /// Fails unless `file` is a regular file, with `words` for what it must be.
  void require_file(const std::string& path, const std::string& file, const std::string& words);

  static std::string method_path(std::size_t i) { return fmt::format("method[{}]", i); }

  const Study& study_;
  const sim::SimulatorInfo* info_;
  Reading& reading_;

 private:
  template <class T>
  static std::string found_words(const T& value) {
    if constexpr (NamedEnum<T>) return quoted(name_of(value));
    if constexpr (std::same_as<T, std::string>) return quoted(value);
    if constexpr (!NamedEnum<T> && !std::same_as<T, std::string>) return fmt::format("{}", value);
  }
};

/// Rules of parts, and between them and the simulator.
void check_source(const Study& study, const sim::SimulatorInfo* info, Reading& reading);
void check_method(const Study& study, std::size_t i, const sim::SimulatorInfo* info,
                  Reading& reading);
void check_policy(const Study& study, const sim::SimulatorInfo* info, Reading& reading);

/// Of the two numbers of a marginal: bounds must be inside of what is physically possible, and a
/// normal must have at most 1e-3 of its mass outside of it: simulations of what is impossible fail.
void check_bounds(const inference::Marginal& marginal, const sim::Parameter& parameter,
                  Reading& reading);

/// Whether the study names exactly one source, as far as its keys could be read.
bool has_source(const Study& study, const Reading& reading);

}  // namespace npdr::pipeline
