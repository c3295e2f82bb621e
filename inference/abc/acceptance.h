/// Acceptance of the simulations that are near enough to the observation.
#pragma once

#include <vector>

#include "core/types.h"
#include "inference/abc/abc_config.h"

namespace npdr::inference {

/// Rows, ascending, and the threshold: distance <= epsilon for each of them.
struct Accepted {
  std::vector<Index> rows;
  double epsilon = 0.0;
};

/// The ceil(quantile n) nearest of the n rows, or fewer when fewer distances are finite; of rows at
/// the same distance the first ones. epsilon is the largest of their distances.
Accepted accept_nearest(const Vector& distances, double quantile);

/// All rows with a distance <= epsilon.
Accepted accept_within(const Vector& distances, double epsilon);

/// Accepts simulations of the prior: within config.epsilon if that is > 0, else the nearest.
Accepted accept_first(const Vector& distances, const AbcConfig& config);

/// Throws Error unless more than `dimension` rows were accepted of all `distances`, which aren't
/// finite of failed ones: fewer don't span the space. Says what to change.
void require_enough(const Accepted& accepted, const Vector& distances, Index dimension);

}  // namespace npdr::inference
