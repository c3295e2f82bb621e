/// Helpers that the checks of a study's settings share. Private to pipeline/config.
#pragma once

#include <string>
#include <vector>

#include "pipeline/config/field_use.h"
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

  /// Fails unless `file` is a regular file, with `words` for what it must be.
  void require_file(const std::string& path, const std::string& file, const std::string& words);

 protected:
  Reading& reading_;
};

}  // namespace npdr::pipeline
