/// Weights by their logarithms, of draws of an unnormalised density.
#pragma once

#include <functional>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// Logarithms, -infinity where they are NaN or infinite.
Vector numbers(const Vector& logs);
/// The largest that is a number; -infinity: none is.
double largest_number(const Vector& logs);
/// exp of logarithms, the largest 1; 0 where a logarithm is no number.
Vector exponentials(const Vector& logs);
/// exponentials(), cut off at their mean times sqrt(n) (Ionides 2008).
Vector truncated(const Vector& logs);

/// The largest power from `low` to `high` that is enough, where all below one that is are, too: by
/// bisection; `low` when none is.
double largest_power(double low, double high, const std::function<bool(double)>& is_enough);

/// Some of weighted points: each at most once, with weights of at least 1.
struct Choice {
  std::vector<Index> rows;
  Vector weights;
};
/// About `most` of them. Row i is kept with probability min(1, w_i / c) and then weighs
/// max(1, w_i / c) (rejection control; Liu, Chen and Wong 1998).
Choice choose_rows(const Vector& weights, Index most, const StreamId& id);

/// Share of weighted points' mass that is above a density's reach: of a point whose log ratio r to
/// the density passes `most`, what is above it, 1 - exp(most - r).
double heavy_share(const Vector& weights, const Vector& log_ratios, double most);

/// log Z = log mean w of the weights' logarithms, and its standard error [nats].
struct Evidence {
  double log_value;
  double error;
};
Evidence evidence(const Vector& logs);

}  // namespace npdr::inference
