/// The two of several quantities that are correlated most.
#pragma once

#include <cmath>

#include "core/types.h"

namespace npdr::pipeline {

struct CorrelatedPair {
  Index first = 0, second = 0;
  double correlation = 0.0;  ///< 0 where there is no pair
};

/// Of a matrix of correlations (D, D), or of what grows with their size.
inline CorrelatedPair most_correlated(const RowMatrix& correlations) {
  CorrelatedPair most;
  for (Index d = 0; d < correlations.rows(); ++d) {
    for (Index e = d + 1; e < correlations.cols(); ++e) {
      const double r = correlations(d, e);
      if (std::abs(r) > std::abs(most.correlation)) most = {d, e, r};
    }
  }
  return most;
}

}  // namespace npdr::pipeline
