/// A shared library of the user's as a source, or npdr's own for models of MuJoCo.
#pragma once

#include <memory>

#include "pipeline/sources/source.h"
#include "sim/library/library_simulator.h"

namespace npdr::pipeline {

class LibrarySource final : public Source {
 public:
  /// Loads the library. Throws InputError.
  explicit LibrarySource(Study study);
  SourceKeys keys() const override;
  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override;

 private:
  std::shared_ptr<const sim::LibrarySimulator> simulator_;
};

}  // namespace npdr::pipeline
