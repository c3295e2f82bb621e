/// A finished dataset as a source: theta and x that somebody has simulated elsewhere.
#pragma once

#include "pipeline/sources/dataset_rows.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {

/// Rows of x (n, F) as a simulator would hand them back: out of limits where theta (n, D) is
/// outside of the prior's support, diverged where an x isn't finite.
sim::Trajectories as_simulated(const inference::Prior& prior, const RowMatrix& theta,
                               const RowMatrix& x);

class DatasetSource final : public Source {
 public:
  using Source::Source;
  SourceKeys keys() const override;
  std::optional<RowMatrix> theta(std::uint64_t seed, Index count) const override;
  std::unique_ptr<RowSimulator> open(const RowsConfig& config) const override;
};

}  // namespace npdr::pipeline
