/// Counts for networks that learn the density of x.
///
/// Where x is an integer its density is infinite, and a network spends what it has on spikes. With
/// noise,
///   y = x + v,  v ~ U(-1/2, 1/2),  p(y) = P(x) for all y that round to x,
/// it has one, whose value at x itself is the probability of x (Uria, Murray and Larochelle 2013,
/// "RNADE", section 4.1; Theis, van den Oord and Bethge 2016, "A note on the evaluation of
/// generative models", section 3.1).
#pragma once

#include <cstdint>
#include <vector>

#include "inference/feature_source.h"

namespace npdr::inference {

/// Numbers of the features that are integers in each of the first kFirstRows rows, ascending.
std::vector<Index> integer_features(const FeatureSource& x);

/// x (N, F) with such noise on its integer features, drawn anew in each epoch: a function of seed,
/// row and epoch, so that several threads may ask. Features that are integers no more after those
/// rows have the noise all the same.
class DequantizedFeatures final : public FeatureSource {
 public:
  /// Keeps a reference to `x`.
  DequantizedFeatures(const FeatureSource& x, std::uint64_t seed);

  Index num_rows() const override { return x_.num_rows(); }
  Index num_features() const override { return x_.num_features(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t epoch,
              RowMatrixF& x) const override;

 private:
  const FeatureSource& x_;
  std::vector<Index> integers_;
  std::uint64_t seed_;
};

}  // namespace npdr::inference
