/// Posterior artefacts that consist of particles (inference/particle_posterior.h).
///
///   particles/theta (n, D), particles/weight (n); attributes of the group: space, smooth,
///   num_chains
///   attributes of the file: algorithm, prior (JSON), num_simulations, num_failed
///   of ABC: abc/distance (n), abc/kernel (D, D), its attribute epsilon; transform/ of features
///   of a regression: regression/mean (W), regression/covariance (W, W); attributes
///   noise_deviation, num_samples, num_non_physical, num_outside_prior
#pragma once

#include "inference/abc/population.h"
#include "inference/linear_regression/bayesian_linear_regression.h"
#include "inference/particle_posterior.h"
#include "pipeline/artefacts/posterior_file.h"

namespace npdr::pipeline {

/// Whether a posterior artefact is of this kind.
bool holds_particles(const h5::File& file);

void write_particles(h5::File& file, const std::string& algorithm,
                     const inference::ParticleParts& parts, const RowCounts& rows);
/// Throws InputError.
std::unique_ptr<inference::ParticlePosterior> read_particles(const h5::File& file);

/// The part of a population that no posterior needs, but the next round does.
void write_population(h5::File& file, const inference::AbcPopulation& population);
/// The population of a round of ABC. Throws InputError.
inference::AbcPopulation read_population(const h5::File& file);

void write_regression(h5::File& file, const inference::WeightPosterior& weights,
                      const RegressionCounts& counts);
std::optional<RegressionCounts> read_regression_counts(const h5::File& file);

}  // namespace npdr::pipeline
