/// Marginals that values look drawn from.
#pragma once

#include <cmath>

#include "core/constants.h"
#include "core/types.h"
#include "inference/diagnostics/levels.h"
#include "inference/prior.h"

namespace npdr::pipeline {

/// Chooses by the largest likelihood, each form at the parameters where its own is largest:
/// uniform and log-uniform between the least and the largest value, normal and log-normal with the
/// moments of the values or of their logarithms. In the order uniform, normal, log-uniform,
/// log-normal one has to be exp(3) times as likely as those before it, draws that are there several
/// times being one, unless inference::are_chosen().
///
/// Of those a grid of 20 values at most is uniform where it is even, and log-uniform where its
/// factors are more so, if one of them is within 0.05 of it by inference::distance_of_levels(), and
/// the nearest of all four if not, as values are that are rounded to few digits.
///
/// Bounds are moved out by half of a step between different values, of a grid of them (1000 at
/// most) and of draws alike, but not below 0 where all are positive, and the first of a small
/// grid isn't as near to it as none: nothing can be learned of values at an end, where the density
/// is cut.
class MarginalFit {
 public:
  /// Takes more values.
  void observe(const Vector& values);

  bool is_constant() const { return !(low_ < high_); }
  /// Without name and unit. Of constant values: uniform.
  inference::Marginal likeliest() const;

 private:
  // Of numbers that come one after the other (Welford 1962).
  struct Moments {
    double mean = 0.0, sum_of_squares = 0.0;
    void observe(double value, Index count);
    double variance(Index count) const { return sum_of_squares / static_cast<double>(count); }
  };

  double num_steps() const;
  double num_draws() const;
  inference::Marginal uniform() const;
  inference::Marginal log_uniform() const;  // as the next, only of values > 0
  inference::Marginal log_normal() const;
  inference::Marginal normal() const;
  inference::Marginal likeliest_of_draws() const;
  inference::Marginal nearest_to_grid() const;

  Index count_ = 0;
  inference::Levels levels_;  ///< the first that came, kMostLevels + 1 of them at most
  double low_ = kInfinity, high_ = -kInfinity;
  Moments values_, logarithms_;  ///< the second of values > 0
};

}  // namespace npdr::pipeline
