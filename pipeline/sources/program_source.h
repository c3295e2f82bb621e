/// A program of the user's as a source: a command that exchanges files, or a worker that answers
/// requests (external_simulator.h).
#pragma once

#include "pipeline/sources/source.h"

namespace npdr::pipeline {

class ProgramSource final : public Source {
 public:
  using Source::Source;
  SourceKeys keys() const override;
  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override;

 protected:
  /// x_o of a command that gives features: what it makes of the truth.
  Target behave_in_features(const std::filesystem::path& log) const override;
};

}  // namespace npdr::pipeline
