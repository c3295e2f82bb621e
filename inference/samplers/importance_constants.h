/// Constants of adaptive importance sampling (importance_sampler.h), with unit and source. "By
/// hand" are those that bound time and memory, or whose order of magnitude alone matters by the
/// reason that is given.
#pragma once

#include "core/types.h"

namespace npdr::inference {

// Proposals.

/// Share of the prior in every proposal, a defensive mixture (Hesterberg 1995): weights are at most
/// 20 times L. By hand.
inline constexpr double kPriorShare = 0.05;
/// Share of the prior in the first proposal, where a start is given: the start may be wrong. By
/// hand; either part then has half of the level.
inline constexpr double kPriorShareOfStart = 0.5;
/// Share and degrees of freedom of Student's t in a fitted flow. Without it, Pareto k was above 1
/// where posteriors were easy: a flow falls too fast where it has seen nothing.
inline constexpr double kTailShare = 0.1;
inline constexpr int kTailDegrees = 5;
/// Points that teach a flow, about, at most: a fit takes seconds. By hand.
inline constexpr Index kTrainingRows = 20'000;
/// Points that weigh something that a flow is fitted to, at least; where more levels wouldn't be
/// kept, two more than there are parameters are enough. By hand: a fifth of them validates.
inline constexpr Index kFewestPoints = 100;
/// Share of all draws without a likelihood above 0 until that is an error. By hand.
inline constexpr double kEmptyShare = 0.1;
/// Flows in the reported levels' proposal, and the smallest ratio of the powers that they were
/// fitted to. By hand: fits of the same points differ by chance.
inline constexpr Index kReportedFlows = 3;
inline constexpr double kAboutAsHigh = 0.8;

// Levels.

/// Effective points that the power of a level asks for, as a share of the level. By hand.
inline constexpr double kWantedShare = 0.2;
/// Levels that count at most, besides the first. With twelve, correlated noise on the recorded
/// swing-ups of the Furuta pendulum ended at power 0.4, with forty at 1.
inline constexpr Index kMostOldLevels = 40;
/// Densities of all levels' proposals at all their points, at most: 400 MB.
inline constexpr double kMostDensities = 5e7;
/// Formerly reported levels that teach, at most: a quarter of kMostOldLevels. By hand.
inline constexpr Index kMostFormerLevels = 10;

// Climbs.

/// Levels that have raised the power by less than to this multiple are stuck. On the Furuta
/// pendulum's recording, flows used 600,000 simulations from 0.08 to 0.085; recordings whose levels
/// rise faster are not touched.
inline constexpr Index kStuckLevels = 10;
inline constexpr double kStuckRise = 1.5;
/// Raises that a climb must have draws for, and share of all draws until its end. By hand: flows
/// and reported levels need the rest.
inline constexpr Index kFewestRaises = 3;
inline constexpr double kClimbShare = 0.75;
/// Sweeps of all walkers that have as many draws as a level, of which one is kept in the end.
inline constexpr Index kSweepsOfLevel = 10;
/// Sweeps at one power, and at the last one, while walkers fill their level. By hand.
inline constexpr Index kSweepsOfPower = 50, kSweepsAtEnd = kSweepsOfLevel * kSweepsOfLevel;
/// Sweeps until neighbors are chosen anew: they change in one near sweep of three, and finding them
/// takes a quarter of a sweep's time.
inline constexpr Index kSweepsOfNeighbors = 6;
/// Effective walkers at the next power, as a share of all (Del Moral, Doucet and Jasra 2006).
inline constexpr double kEffectiveWalkers = 0.5;

// Results.

/// Effective draws of the reported levels, as a share of the wanted ones, below which the points of
/// all levels are given in their place. By hand: a hundred of a thousand still tell means.
inline constexpr double kFewOfWanted = 0.1;
/// Largest Pareto k at which means converge fast enough (Vehtari et al. 2024), and the efficiency
/// from which on it doesn't matter: half of the draws count.
inline constexpr double kLargestParetoK = 0.7;
inline constexpr double kGoodEfficiency = 0.5;
/// Share of pi that may be missed: as little as other errors of a posterior.
inline constexpr double kMostMissed = 0.05;
/// Share of pi that a search tells of, at least; the rest of its reasons are in weight_search.h.
inline constexpr double kLeastFound = 0.01;
/// Draws of a search, as a share of all before it. By hand.
inline constexpr double kSearchShare = 0.1;
/// Searches, each after what the one before has found was learned. By hand.
inline constexpr Index kMostSearches = 4;
/// Difference of two log Z, in standard errors; beyond that either way by chance: 6e-5.
inline constexpr double kLargestDifference = 4.0;

}  // namespace npdr::inference
