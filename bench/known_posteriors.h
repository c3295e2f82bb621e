/// Inference tasks whose posterior can be sampled, given any observation: those of the benchmark of
/// Lueckmann et al. (2021, "Benchmarking Simulation-Based Inference") with the same names there,
/// and slcp with 92 more features that say nothing. Exactly, but for four (likelihood_tasks.h).
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
  /// n samples (n, D) of p(theta | x_o). Throws Error where they can't be trusted.
  std::function<RowMatrix(const VectorF& x_o, Index n, std::uint64_t seed)> exact_samples;
};

/// "two_moons", "slcp", "gaussian_linear", "gaussian_linear_uniform", "gaussian_mixture",
/// "bernoulli_glm_whitened", "bernoulli_glm_whitened_raw", "sir", "lotka_volterra",
/// "slcp_with_noise".
std::vector<std::string> known_posterior_names();
/// Throws InputError for another name.
KnownPosterior known_posterior(const std::string& name);

/// x_o (F) of a theta of the prior; another one for each number.
VectorF observation(const KnownPosterior& task, Index number);

/// Independent marginals of one kind: theta_1, theta_2, ...
inference::Prior same_marginals(Index dimension, inference::Marginal::Kind kind, double a,
                                double b);

}  // namespace npdr::bench
