/// Does a posterior press against a bound of the prior, which may then exclude the truth?
///
/// With v = F(theta_d) uniform under the prior, and w the width of the samples' central 80 %, an
/// edge is the values of v within w / 4 of 0, or of 1. Its share of the samples is 1/5 where the
/// posterior is as even as the prior, 0.30 for half a Gaussian with its mode on the bound, 0.36 and
/// 0.39 where the bound cuts one off at one and two deviations beyond its mode, and 0.42 at most,
/// far beyond.
///
/// A network that extrapolates leaves a gap instead, between the bound and all of its samples: a
/// posterior presses also where 90 % of them lie within v < 0.005, or > 0.995. And a density that
/// nothing holds back where no simulation is, as that of the atomic loss, leaks towards infinite u,
/// while the rest of it stays where it belongs: 2 % of the samples within v < 1e-5, or > 1 - 1e-5.
///
/// Where the bounds hold the truth, a mode lies one deviation s (of v) beyond one of them with
/// probability 0.17 s: that is about the false-alarm rate of a parameter, 0.2 % for s = 0.01 and
/// 3 % for the widest, since w must be below a quarter of the prior's. The mass of exact posteriors
/// below v = 0.005 is 0.005 in the mean, so it is 90 % with probability of at most 0.005 / 0.9, and
/// 1.1 % at any of the two bounds. So is that below v = 1e-5: 2 % with a probability of at most
/// 5e-4, and 0.1 % of a parameter at any of the two.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Samples within the edges.
struct BoundPressure {
  double lower = 0.0;  ///< share of the samples that lie at the lower bound
  double upper = 0.0;
  double below = 1.0;      ///< 90 % of the samples have a smaller v
  double above = 0.0;      ///< or a larger one
  double lowest = 0.0;     ///< share of the samples so low that hardly any prior's is
  double highest = 0.0;    ///< so high
  bool is_narrow = false;  ///< w < kNarrow

  bool leaks_lower() const { return lowest >= kLeakingShare; }
  bool leaks_upper() const { return highest >= kLeakingShare; }
  bool presses_lower() const {
    return (is_narrow && lower > kPressingShare) || below < kGap || leaks_lower();
  }
  bool presses_upper() const {
    return (is_narrow && upper > kPressingShare) || above > 1.0 - kGap || leaks_upper();
  }

  static constexpr double kEdge = 0.25;           ///< of w, from a bound
  static constexpr double kNarrow = 0.2;          ///< of v: a quarter of the prior's w
  static constexpr double kPressingShare = 0.36;  ///< of the samples, within an edge
  static constexpr double kGap = 0.005;           ///< of v, between a bound and 90 % of the samples
  static constexpr double kTail = 1e-5;           ///< of v, from a bound
  static constexpr double kLeakingShare = 0.02;   ///< of the samples, within the tail
};

/// Fewer samples than this don't tell one share from the other.
inline constexpr Index kFewestForBounds = 100;

/// Tests v (n), in [0, 1]. Throws InputError for fewer than kFewestForBounds.
BoundPressure test_bounds(Vector v);

}  // namespace npdr::inference
