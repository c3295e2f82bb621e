/// Inference tasks whose posterior can be sampled exactly, given any observation. The first four
/// are those of the benchmark of Lueckmann et al. (2021, "Benchmarking Simulation-Based Inference")
/// with the same names there; the fifth is there, too, and the last one is slcp with 92 more
/// features that say nothing.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "inference/in_memory.h"

namespace npdr::bench {

struct KnownPosterior {
  std::string name;
  inference::Prior prior;
  inference::SimulatorFunction simulator;
  /// One exact sample (D) of p(theta | x_o).
  std::function<Vector(const VectorF& x_o, Stream& stream)> exact;
};

/// "two_moons", "slcp", "gaussian_linear", "gaussian_linear_uniform", "gaussian_mixture",
/// "slcp_with_noise".
std::vector<std::string> known_posterior_names();
/// Throws InputError for another name.
KnownPosterior known_posterior(const std::string& name);

/// x_o (F) of a theta of the prior; another one for each number.
VectorF observation(const KnownPosterior& task, Index number);

/// (n, D) exact samples given x_o; row i has a stream of its own.
RowMatrix exact_samples(const KnownPosterior& task, const VectorF& x_o, Index n,
                        std::uint64_t seed);

}  // namespace npdr::bench
