/// A program of the user's as a source: a command that exchanges files, or a worker that answers
/// requests (external_simulator.h).
#pragma once

#include "pipeline/sources/file_hashes.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {

class ProgramSource final : public Source {
 public:
  /// Reads the files that its command names, and simulator.files. Throws InputError for one that
  /// can't be read.
  explicit ProgramSource(Study study);
  SourceKeys keys() const override;
  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override;

 protected:
  /// x_o of a command that gives features: what it makes of the truth.
  Target behave_in_features(const std::filesystem::path& log) const override;

 private:
  FileHashes named_, further_;
};

}  // namespace npdr::pipeline
