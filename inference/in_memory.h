/// Inference with everything in memory, for a simulator that is a function: rounds of proposing,
/// simulating and training, as the pipeline makes them with files.
#pragma once

#include <functional>
#include <memory>

#include "inference/abc/abc_config.h"
#include "inference/algorithms/posterior_estimation.h"
#include "inference/particle_posterior.h"

namespace npdr::inference {

/// x (F) ~ p(x | theta), with the stream of its row.
using SimulatorFunction = std::function<VectorF(const Vector& theta, Stream& stream)>;

/// x (n, F) of theta (n, D); row i has the stream (seed, "simulate", round, i).
RowMatrixF simulate(const SimulatorFunction& simulator, const RowMatrix& theta, std::uint64_t seed,
                    std::uint64_t round);

/// The posterior after all rounds of the config, each with its num_simulations, given x_o (F).
std::shared_ptr<const NetworkPosterior> infer(const PosteriorEstimationConfig& config,
                                              const Prior& prior,
                                              const SimulatorFunction& simulator,
                                              const VectorF& x_o, std::uint64_t seed);

/// The posterior after all rounds by approximate Bayesian computation, with the Euclidean distance
/// of features.
std::shared_ptr<const ParticlePosterior> infer_abc(const AlgorithmConfig& algorithm,
                                                   const AbcConfig& config, const Prior& prior,
                                                   const SimulatorFunction& simulator,
                                                   const VectorF& x_o, std::uint64_t seed);

}  // namespace npdr::inference
