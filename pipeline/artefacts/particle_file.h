/// Posterior artefacts that consist of particles (inference/particle_posterior.h).
#pragma once

#include "inference/abc/population.h"
#include "inference/particle_posterior.h"
#include "pipeline/artefacts/posterior_file.h"

namespace npdr::pipeline {

/// Whether a posterior artefact is of this kind.
bool holds_particles(const h5::File& file);

/// Throws Error.
void write_particles(h5::File& file, const std::string& algorithm, inference::ParticleParts parts,
                     RowCounts rows);
/// Throws InputError.
std::unique_ptr<inference::ParticlePosterior> read_particles(const h5::File& file);

/// Writes what no posterior needs of a population, but the next round does. Throws Error.
void write_population(h5::File& file, inference::AbcPopulation population);
/// The population of a round of ABC. Throws InputError.
inference::AbcPopulation read_population(const h5::File& file);

/// States that segments begin in by a least-squares fit.
struct FittedStates {
  RowMatrix states;  ///< (S, C), rollout by rollout
};
void describe(Layout f, std::optional<FittedStates>& fitted);

/// The part of a regression's posterior.
void describe(Layout f, std::optional<RegressionCounts>& counts);

}  // namespace npdr::pipeline
