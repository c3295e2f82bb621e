/// Helpers that the checks of a study's settings share. Private to pipeline/config.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/text.h"
#include "pipeline/config/field_list.h"
#include "pipeline/config/problems.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Notes down in a reading what is wrong with settings. Paths are those of the reading, such as
/// "method[0].training"; messages show them without positions.
class Checker {
 public:
  explicit Checker(Reading& reading) : reading_(reading) {}

  /// Adds `path = found, must be words`.
  void fail(const std::string& path, const std::string& found, const std::string& words);

  /// The same unless `is_allowed`, where nothing is wrong with `path` and `others`.
  template <class T>
  bool require(const std::string& path, const T& found, bool is_allowed, const std::string& words,
               std::initializer_list<std::string> others = {}) {
    const auto is_good = [&](const std::string& other) { return reading_.good(other); };
    if (is_allowed || !is_good(path) || !std::ranges::all_of(others, is_good)) return is_allowed;
    fail(path, found_words(found), words);
    return false;
  }

  /// Adds `path must be left out: why` where the path is there.
  void must_be_left_out(const std::string& path, const std::string& why);

  /// The same where they are there. Of those that --set may give, only where the file has them.
  void must_be_left_out(const std::vector<UnusedField>& fields);

  /// Whether a path stands in the study file; one of --set may be meant for other methods.
  bool is_in_file(const std::string& path) const;

  /// Whether `name` is one of `known`; adds `where: unknown kind 'name'; ...` at `path` when not.
  bool require_known(const std::string& path, const std::string& where, const std::string& kind,
                     const std::string& name, const std::vector<std::string>& known);

  /// The parameter of that name; nullptr, and the problem noted down as above, when the simulator
  /// has none.
  const sim::Parameter* find_parameter(const std::string& path, const std::string& where,
                                       const sim::SimulatorInfo& info, const std::string& name);

  /// Fails for a value outside of the parameter's limits.
  void check_value(const std::string& path, const sim::Parameter& parameter, double value);

  /// Labels of channels.
  static std::vector<std::string> labels_of(const std::vector<Channel>& channels);

  /// Fails unless `file` is a regular file, with `words` for what it must be.
  void require_file(const std::string& path, const std::string& file, const std::string& words);

 protected:
  static std::string found_words(const std::string& text) { return quoted(text); }
  static std::string found_words(bool flag) { return flag ? "true" : "false"; }
  template <class T>
  static std::string found_words(const T& value) {
    if constexpr (NamedEnum<T>) {
      return quoted(name_of(value));
    } else {
      return fmt::format("{}", value);
    }
  }

  Reading& reading_;
};

}  // namespace npdr::pipeline
