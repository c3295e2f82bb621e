/// The simulators of sim/ as a source.
#pragma once

#include "pipeline/sources/source.h"

namespace npdr::pipeline {

class BuiltInSource final : public Source {
 public:
  using Source::Source;
  SourceKeys keys() const override;
  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override;

 protected:
  Target behave_by_itself() const override;
};

}  // namespace npdr::pipeline
