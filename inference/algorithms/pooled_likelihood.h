/// The likelihood l(z | u) that "npe_nle" pools with its posterior: of what it is learned, and how.
///
/// It sees the features that the posterior sees. That of many costs much and says little: of more
/// than kMostPooledFeatures it sees the informative_features(), or kPooledComponents principal
/// components where those are more, too; components also where the posterior has trained layers,
/// whose outputs have no density. Given theta, components are sums of noise and nearly normal:
/// where the posterior has splines ("nsf"), their likelihood has affine maps ("maf"), which say as
/// much of fresh simulations, sooner, and are better where no simulation is like the observation.
#pragma once

#include "inference/algorithms/posterior_estimation.h"

namespace npdr::inference {

inline constexpr Index kMostPooledFeatures = 50;
inline constexpr Index kPooledComponents = 20;

/// All but the weights. `training`: the simulations that train; `posterior`: the networks that it
/// is pooled with, at least one of whose features varies.
PooledLikelihood untrained_likelihood(const PosteriorEstimationConfig& config,
                                      const RoundData& training, const NetworkParts& posterior);

}  // namespace npdr::inference
