/// Covariances and weights of minima (least_squares.h). Private to inference/least_squares.
#pragma once

#include <vector>

#include "inference/least_squares/descent.h"

namespace npdr::inference {

/// The minima that searches ended in, the best first, as a mixture of Gaussians over u; all but the
/// best weigh 1e-4 or more. Costs 2 D simulations a search.
std::vector<Minimum> laplace_mixture(Simulations& simulations, std::vector<Search> searches);

}  // namespace npdr::inference
