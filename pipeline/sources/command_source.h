/// A program of the user's as a source: it gives features of x, a file of theta and a file of x a
/// call (external_simulator.h).
#pragma once

#include "pipeline/sources/source.h"

namespace npdr::pipeline {

class CommandSource final : public Source {
 public:
  using Source::Source;
  SourceKeys keys() const override;
  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override;
  /// x_o: what the command makes of the truth.
  Target behave(const std::filesystem::path& log) const override;
};

}  // namespace npdr::pipeline
