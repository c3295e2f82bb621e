/// Test of whether an observation looks like the simulations that a network has seen. Outside of
/// them it extrapolates, and its posterior means nothing (Cannon, Ward and Schmon 2022,
/// "Investigating the impact of model misspecification in neural simulation-based inference").
///
/// x is standardized, where asked for without the tails of features that span orders of magnitude
/// (over their deviation all small values would be one), and projected on principal components of
/// unit variance, z, as many as have 99 % of the variance, at most 20; half of the simulations make
/// that map, the other half say what is usual. Three distances:
/// - |z|, Mahalanobis' within the components (Lee et al. 2018, "A simple unified framework for
///   detecting out-of-distribution samples and adversarial attacks"): far out in known directions;
/// - the residual beyond the components (Jackson and Mudholkar 1979, "Control procedures for
///   residuals associated with principal component analysis"): a direction that no simulation has;
///   infinite where the observation differs in a feature that is the same in all simulations, or
///   lies nearer to 0 than any of them by far;
/// - to the nearest simulation of the first half, in z: a hole or a bend of the distribution.
#pragma once

#include <optional>

#include "inference/feature_transform.h"

namespace npdr::inference {

/// One distance of the observation.
struct Distance {
  double observed = 0.0;
  double median = 0.0;   ///< of simulations
  double p_value = 1.0;  ///< P(a simulation is as far), tail_probability.h
};

/// The three distances, tested together.
struct OutOfDistribution {
  Index num_components = 0;  ///< k
  Index num_reference = 0;   ///< simulations that say what is usual
  Distance mahalanobis;
  Distance residual;
  Distance nearest;
  double p_value = 1.0;  ///< three times the smallest of the three, at most 1
};

/// Fewer simulations than this say nothing.
inline constexpr Index kFewestSimulations = 40;
/// Simulations for each principal component, at least.
inline constexpr Index kRowsPerComponent = 20;

/// Summary of the features x of simulations: all that the test needs of them.
struct UsualFeatures {
  FeatureTransform transform;  ///< of z: its basis is (F, k)
  RowMatrixF known;            ///< (m, k), z of the first half
  RowMatrix distances;         ///< (n, 3) of the second: Mahalanobis', residual, nearest
  VectorF lowest;              ///< (F), of both
  VectorF highest;
};

/// That of simulations x (n, F), which are independent draws in any order. At most one component
/// for kRowsPerComponent rows of a half. `tails`: what becomes of features that span orders of
/// magnitude (feature_transform.h). Throws InputError for fewer than kFewestSimulations rows, or
/// what isn't finite.
UsualFeatures usual_features(const RowMatrixF& x, Tails tails = Tails::kept);

/// The first feature that is the same in all simulations, and another in x_o (F); or, of those that
/// span orders of magnitude (and are compressed), on one side of 0 in all of them, and in x_o on
/// the other or 100 times nearer to it, which logarithms of a kind don't show. Where the density of
/// such a feature is finite at 0, the next of n simulations does so with probability 0.01 / n.
std::optional<Index> impossible_feature(const UsualFeatures& usual, const VectorF& x_o);

/// Tests x_o (F). Throws ShapeError when the widths differ and InputError for what isn't finite.
OutOfDistribution test_out_of_distribution(const UsualFeatures& usual, const VectorF& x_o);

/// Whether so many simulations that say what is usual can give a p-value below `level` at all, of
/// what isn't infinitely far.
bool can_be_outside(Index num_reference, double level);

}  // namespace npdr::inference
