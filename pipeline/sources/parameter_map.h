/// The map between the D parameters of a study's prior and the P parameters of its simulator.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/config/study.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// Const calls are thread-safe.
class ParameterMap {
 public:
  /// `info`: of the study's simulator. Throws InputError for a parameter of the prior that it
  /// doesn't have.
  ParameterMap(const Study& study, const sim::SimulatorInfo& info);

  /// All parameters (P): the study's nominal ones, `values` in place of some. Throws InputError for
  /// an unknown name, here or in simulator.parameters.
  Vector nominal(const std::map<std::string, double>& values = {}) const;

  /// All parameters (n, P) for theta (n, D): what isn't in the prior is nominal.
  RowMatrix complete(const RowMatrix& theta) const;

  /// theta (n, D) among all parameters (n, P).
  RowMatrix pick(const RowMatrix& complete) const;
  /// theta (D) among all parameters (P).
  Vector pick_one(const Vector& complete) const;

 private:
  sim::SimulatorInfo info_;
  std::map<std::string, double> nominal_values_;  // of the study
  std::vector<Index> columns_;                    // (D) among the P
};

}  // namespace npdr::pipeline
