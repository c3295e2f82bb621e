/// Posterior artefacts: portable files that hold everything a posterior is.
///
///   weights (P) float32            of the whole network, flat
///   transform/mean, transform/inverse_deviation (F), transform/basis (F, k)
///   x_o (F)                        the observation, not transformed; attributes that say what was
///                                  observed: dt, num_rollouts, num_steps, state_labels,
///                                  state_units, action_labels, action_units
///   training/training_loss, training/validation_loss (epochs)
///   proposal/mean (D), proposal/precision_factor (D, D): NPE-A's, where the network's answer must
///   be divided by it
///   attributes: network_role, sampler (JSON), prior, density_estimator, embedding (JSON),
///   trained_features, structure_seed, num_simulations, num_failed
#pragma once

#include "inference/algorithms/posterior_estimation.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// The settings of a method as inference takes them.
inference::PosteriorEstimationConfig estimation_config(const MethodConfig& method);

/// How many rows of the simulations were used and left out.
struct RowCounts {
  Index used = 0;
  Index failed = 0;
};

/// `target`: the rollouts that x_o was made of.
void write_posterior(h5::File& file, const MethodConfig& method,
                     const inference::NetworkPosterior& posterior, const Target& target,
                     const inference::TrainingState& training, const RowCounts& rows);

/// Reads the posterior of a file, whatever study and algorithm made it. Throws InputError.
std::unique_ptr<inference::Posterior> read_posterior(const ArtefactFile& artefact);

/// The same of one that a network gives: an InputError for any other (particle_file.h), which holds
/// for its own observation alone.
std::unique_ptr<inference::NetworkPosterior> read_network_posterior(const ArtefactFile& artefact);

/// The channels of the rollouts that x_o was made of.
Channels observed_channels(const std::filesystem::path& posterior);

/// Throws InputError unless `found`, with the observed_channels(), could be observed in place of
/// what the posterior in the file was trained for: the same dt (to 0.1 %), numbers of rollouts and
/// steps. `where` (a file) begins the message.
void require_like_observation(const std::string& where, const Target& found,
                              const std::filesystem::path& posterior);

/// Samples of a regression's weights: how many there are, give parameters that the simulator's
/// limits exclude, and lie outside of the prior.
struct RegressionCounts {
  Index samples = 0;
  Index non_physical = 0;
  Index outside_prior = 0;
};

/// What stands beside the posterior.
struct PosteriorNotes {
  RowCounts rows;
  std::optional<RegressionCounts> regression;
  Vector training_loss;    ///< (epochs); empty without a network
  Vector validation_loss;  ///< (epochs)
};
PosteriorNotes read_posterior_notes(const ArtefactFile& artefact);

/// What a training run goes on from.
struct Checkpoint {
  inference::TrainingState training;
  Cost cost;  ///< of the work that led here
};
/// The checkpoint of the posterior `identity`.
void write_checkpoint(const std::filesystem::path& path, const Identity& identity,
                      const Checkpoint& checkpoint);
/// An empty state when there is no checkpoint. Throws InputError for a damaged one.
Checkpoint read_checkpoint(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
