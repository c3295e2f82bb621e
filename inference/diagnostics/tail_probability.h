/// Probability of a value as extreme as the one found, judged by draws of its distribution.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// P(X >= observed), X distributed as the n values of `reference`, which are in no order.
/// - Where ten or more reach `observed`, (1 + their number) / (1 + n): the p-value of a permutation
///   test.
/// - What is infinite where no draw is can't be any of them: 1 / (1000 n), the smallest result.
/// - Beyond, fewer say too little: the excesses of the largest tenth (at least ten) over a
///   threshold are described by a generalized Pareto distribution (Pickands 1975; Knijnenburg et
///   al. 2009, "Fewer permutations, more accurate P-values"; inference/pareto_tail.h). Its shape is
///   taken as at least 0, so that no tail is said to end, and the result as at least 1 / (1000 n).
///   Nor is it less than those that reach `observed` bear out, k (1 - 1 / (9 k) - 1.28 / (3
///   sqrt(k)))^3 / n of k of them: the lower end of an interval for what is expected (Garwood 1936,
///   by Wilson and Hilferty 1931) that is above the truth in 10 % of cases. Rare values that lie
///   together far out have no Pareto tail.
/// With n < 40 it is always one of the first two, and up to the largest draw also where fewer than
/// half of that tenth differ: counts, or zeros and ones, have no smooth tail. Equal values aren't
/// torn apart by the threshold: the tail is those above them, or of ten or fewer those as well, and
/// where they are the smallest of all, or all of the tail, it is counted. NaN counts as infinite.
/// Throws InputError for no reference.
double tail_probability(const Vector& reference, double observed);

/// The smallest that n reference values can give of a finite value: of fewer than 40 none is rare.
double smallest_tail_probability(Index n);

}  // namespace npdr::inference
