/// Growth of one Gaussian to a mixture, for the last round of NPE-A.
///
/// Papamakarios and Murray 2016, section 2.3: the mixture begins as copies of the Gaussian of the
/// rounds before, each disturbed a little, so that they can become different.
#pragma once

#include "inference/network_posterior.h"

namespace npdr::inference {

/// Weights of the network with `grown` components for that of `single`, which has one: the same
/// trunk, the head's columns copied, all but those of the mixture's weights disturbed by Gaussian
/// noise with the standard deviation `perturbation`.
Parameters<float> grow_components(const NetworkParts& single, const EstimatorConfig& grown,
                                  double perturbation, const StreamId& id);

}  // namespace npdr::inference
