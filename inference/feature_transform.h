/// Transform of x before the network: standardization and, if asked for, a projection on its
/// principal components.
///
///   z = (x - mean) / deviation   (F),       z = B^T (x - mean) / deviation   (k)
/// with the columns of B (F, k) the eigenvectors of the correlation matrix of x with the largest
/// eigenvalues (Pearson 1901), each divided by the root of its eigenvalue, so that z has unit
/// variance. N simulations span at most N directions, and far fewer of them carry signal: a trained
/// linear layer on k components is the same kind of map as on x, cheaper and with far fewer weights
/// to overfit. Of an observation that no simulation reproduces, z keeps what lies in their span.
///
/// With Tails::compressed, features that span orders of magnitude are compressed before all that
/// (heavy_tails.h): x above is then asinh((x - center) / scale). With Tails::both, which is for
/// networks that are given x, they are there twice: K copies, as they are, follow the F features.
/// Small values differ in the former, sums of large ones can be learned from the latter.
///
/// A few simulations that all but diverged (a resonance, a stiff parameter) must not set the scale
/// for all others: mean and deviation are those of x clamped to bounds far outside of the usual, 20
/// times the distance of the 5 % and 95 % quantiles beyond them (where these agree, 41 times as far
/// from their value as 95 % of the others), and a standardized s beyond +-100 becomes
/// +-(100 + log(|s| / 100)): it can still be told from others. Where nothing is that far out
/// neither changes a bit.
#pragma once

#include <vector>

#include "core/types.h"
#include "inference/feature_source.h"

namespace npdr::inference {

struct FeatureTransform {
  static constexpr float kFarthest = 100.0f;        ///< standardized value that counts in full
  static constexpr double kLeastDeviation = 2e-38;  ///< of a feature that varies

  VectorF mean;                ///< (F + K)
  VectorF inverse_deviation;   ///< (F + K); 0: the feature doesn't vary, and carries nothing
  RowMatrixF basis;            ///< (F + K, k); (0, 0): no projection
  VectorF center = {};         ///< (F) of compressed features; empty: none is
  VectorF inverse_scale = {};  ///< (F) theirs; 0: this one isn't

  Index num_inputs() const { return center.size() > 0 ? center.size() : mean.size(); }
  /// K: 0, or how many features are compressed.
  Index num_copies() const { return mean.size() - num_inputs(); }
  Index num_outputs() const { return basis.cols() > 0 ? basis.cols() : mean.size(); }

  /// Features as far as they are standardized, (n, F) -> (n, F + K), however large.
  void standardize(const RowMatrixF& x, RowMatrixF& z) const;
  /// z of every row of x: (n, F) -> (n, F + K or k).
  void apply(const RowMatrixF& x, RowMatrixF& z) const;
};

/// Treatment of features that span orders of magnitude.
enum class Tails { kept, compressed, both };

/// The transform for the rows of `x`, from their mean and deviation and, for components > 0, from
/// the correlation of the first 2000 of them, which has no more components than features or rows.
/// Reads x in blocks: memory doesn't grow with its rows.
FeatureTransform fit_feature_transform(const FeatureSource& x, Index components,
                                       Tails tails = Tails::kept);

/// `transform`, which has no components, without copies: for the density of x itself.
FeatureTransform without_copies(FeatureTransform transform);

/// `transform` with those of its outputs alone, in that order.
FeatureTransform selected_outputs(const FeatureTransform& transform,
                                  const std::vector<Index>& outputs);

/// Of these features the ones whose most frequent value is that of at most 99 % of the first 2000
/// of x; all of them, if there is none.
std::vector<Index> varying_features(const std::vector<Index>& features, const FeatureSource& x);
/// `transform` without the outputs that are 0 for all simulations, and where it has no components
/// those of the varying_features() alone: where the density of z itself is learned, that of others
/// would be infinite, or nearly so. Throws InputError when none is left.
FeatureTransform varying_outputs(const FeatureTransform& transform, const FeatureSource& x);
/// How many outputs aren't 0 for all simulations.
Index num_varying_outputs(const FeatureTransform& transform);

}  // namespace npdr::inference
