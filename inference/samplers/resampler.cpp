#include "inference/samplers/resampler.h"

#include <algorithm>
#include <numeric>

#include "core/error.h"
#include "inference/weighted_moments.h"

namespace npdr::inference {

Resampler::Resampler(const Vector& weights)
    : cumulative_(weights.size()), effective_size_(inference::effective_size(weights)) {
  if (!weights.allFinite() || !(weights.minCoeff() >= 0.0) || !(weights.sum() > 0.0)) {
    throw Error("resampling: weights must be finite, >= 0, and not all of them 0");
  }
  std::partial_sum(weights.begin(), weights.end(), cumulative_.begin());
  cumulative_ /= cumulative_(cumulative_.size() - 1);
}

Index Resampler::draw(double uniform) const {
  const auto found = std::lower_bound(cumulative_.begin(), cumulative_.end(), uniform);
  return std::min<Index>(found - cumulative_.begin(), cumulative_.size() - 1);
}

std::vector<Index> Resampler::systematic(Index count, double uniform) const {
  std::vector<Index> rows;
  for (Index i = 0; i < count; ++i) {
    rows.push_back(draw((static_cast<double>(i) + uniform) / static_cast<double>(count)));
  }
  return rows;
}

}  // namespace npdr::inference
