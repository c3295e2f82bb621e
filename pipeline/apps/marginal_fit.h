/// Marginals that values look drawn from.
#pragma once

#include <cmath>
#include <set>

#include "core/types.h"
#include "inference/prior.h"

namespace npdr::pipeline {

/// Chooses by the largest likelihood, each form at the parameters where its own is largest:
/// uniform and log-uniform between the least and the largest value, normal and log-normal with the
/// moments of the values or of their logarithms. Another form than uniform has to be exp(3) times
/// as likely, and of at most 20 values those of a grid of even steps aren't log-uniform. Bounds are
/// then moved out by half of a step between different values, of a grid of them (10,000 at most)
/// and of draws alike, but not below 0 where all are positive: nothing can be learned of values at
/// an end, where the density is cut.
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
  bool is_even_grid() const;  // rather than one of even factors

  Index count_ = 0;
  std::set<double> different_;  ///< so many that they can't be a grid's at most
  double low_ = HUGE_VAL, high_ = -HUGE_VAL;
  Moments values_, logarithms_;  ///< the second of values > 0
};

}  // namespace npdr::pipeline
