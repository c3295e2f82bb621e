/// Inference tasks whose posterior can be sampled exactly, as in the benchmark of Lueckmann et al.
/// (2021, "Benchmarking Simulation-Based Inference"), which has them as "two moons" (T.8) and
/// "Gaussian linear" (T.1).
#pragma once

#include <string>
#include <vector>

#include "inference/in_memory.h"

namespace npdr::bench {

struct KnownPosterior {
  std::string name;
  inference::Prior prior;
  inference::SimulatorFunction simulator;
  VectorF x_o;                                  ///< (F)
  std::function<Vector(Stream& stream)> exact;  ///< one exact posterior sample, (D)
};

/// "two_moons", "gaussian_linear" (10 dimensions).
std::vector<std::string> known_posterior_names();
/// Throws InputError for another name.
KnownPosterior known_posterior(const std::string& name);

/// (n, D) exact samples; row i has a stream of its own.
RowMatrix exact_samples(const KnownPosterior& task, Index n, std::uint64_t seed);

}  // namespace npdr::bench
