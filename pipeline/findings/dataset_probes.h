/// What is wrong with the rows of a dataset.
#pragma once

#include <string>
#include <vector>

#include "core/finding.h"
#include "inference/prior.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Looks at theta (n >= 1, D), all of it in the prior, for what draws of that don't have. What is
/// grave is wrong: posteriors are those of something else. Of each parameter:
/// - It is the same in all rows: grave.
/// - Its least or largest value lies within 1e-6 of an end of F, where the density of a bounded
///   prior is cut, as that of a grid or of rounded draws does, or is more frequent than others, as
///   that of clipped draws is: told from a fiftieth of the rows on, grave above 0.075.
/// - It is distributed in another way than the prior, by Kolmogorov and Smirnov's test of
///   inference::distance_of_levels(): grave where that is above 0.05.
/// - 0.15 of the rows or more have one value, which is twice as many as others have, or it has less
///   than five.
/// And the pair whose F are correlated most surely: grave above 0.2.
///
/// Draws of the prior are accused by each of the two tests with a probability of 1e-4 at most. Rows
/// of the same theta, which are about as often there each, are one draw, and so are those that
/// share a parameter unless its values are inference::are_chosen(). A design, of 20 different
/// values at most, wasn't drawn: of it every row counts.
Findings find_in_theta(const RowMatrix& theta, const inference::Prior& prior);

/// Looks at the rows that `methods` train on with `seed`.
/// - At theta of 10,000 of them at most, by find_in_theta().
/// - At 100,000 for rows that are there twice: they count several times, and judge as validation
///   what they have taught. Grave where they are a twentieth, and ten times as many as are
///   expected of rows that were drawn by themselves, given how many values each parameter has. None
///   where x of the same theta is mostly another, so that some of it, such as counts, may agree by
///   chance.
/// Nothing of a source that simulates. Throws InputError for a damaged dataset.
Findings find_in_dataset(const Plan& plan, const std::vector<std::string>& methods,
                         std::uint64_t seed);

}  // namespace npdr::pipeline
