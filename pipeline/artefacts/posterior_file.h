/// Posterior artefacts: portable files that hold everything a posterior is.
#pragma once

#include "inference/algorithms/posterior_estimation.h"
#include "inference/diagnostics/out_of_distribution.h"
#include "inference/linear_regression/bayesian_linear_regression.h"
#include "inference/samplers/importance_sampler.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/config/study.h"
#include "pipeline/store/artefact.h"
#include "sim/error_memory.h"

namespace npdr::pipeline {

/// The settings of a method as inference takes them. `series`: what its embedding picks, for layers
/// that are trained; a proposal needs none.
inference::PosteriorEstimationConfig estimation_config(const MethodConfig& method,
                                                       const inference::SeriesShape& series = {});

/// How many rows of the simulations were used and left out.
struct RowCounts {
  Index used = 0;
  Index failed = 0;
};

/// `target`: the rollouts that x_o was made of; `usual`: what x of its simulations is. Throws
/// Error.
void write_posterior(h5::File& file, const MethodConfig& method,
                     const inference::NetworkPosterior& posterior, const Target& target,
                     const std::vector<inference::TrainingState>& trainings, RowCounts rows,
                     std::optional<inference::UsualFeatures> usual);

/// Reads the posterior of a file, whatever study and algorithm made it. Throws InputError.
std::unique_ptr<inference::Posterior> read_posterior(const ArtefactFile& artefact);

/// The same of one that a network gives: an InputError for any other (particle_file.h), which holds
/// for its own observation alone.
std::unique_ptr<inference::NetworkPosterior> read_network_posterior(const ArtefactFile& artefact);

/// Attributes that posteriors of all kinds share.
void describe(Layout f, std::vector<inference::Marginal>& prior);
void describe(Layout f, RowCounts& rows);

/// The channels of the rollouts that x_o was made of. Throws InputError.
Channels observed_channels(const std::filesystem::path& posterior);

/// Throws InputError, which begins with `where`, unless `found` has the dt (to 0.1 %) and numbers
/// of rollouts and steps of what the posterior in the file was trained for.
void require_like_observation(const std::string& where, const Target& found,
                              const std::filesystem::path& posterior);

/// Samples of a regression's weights: of all, that give impossible parameters, outside of the
/// prior.
struct RegressionCounts {
  Index samples = 0;
  Index non_physical = 0;
  Index outside_prior = 0;
  inference::WeightPosterior weights = {};  ///< that they are drawn from; not read
};

/// Losses of a network's training, (epochs).
struct TrainingLosses {
  Vector training;
  Vector validation;
};

/// How much the likelihood of "npe_nle" counts (pooled_posterior.h).
struct PoolNotes {
  inference::PoolPowers powers;         ///< by held-out simulations
  inference::PoolPowers powers_at_x_o;  ///< nearer to (1, 0) where networks contradict each other
  double log_normalizer = 0.0;          ///< at x_o [nats]
  double missed_share = 0.0;            ///< of the likelihood's posterior, by the pool
};

/// Counts and losses that stand beside the posterior.
struct PosteriorNotes {
  RowCounts rows;
  std::optional<RegressionCounts> regression;
  std::optional<inference::ImportanceCertificate> certificate;
  std::vector<TrainingLosses> losses;             ///< one a network
  std::vector<TrainingLosses> likelihood_losses;  ///< the same of those of a pool's likelihood
  std::optional<PoolNotes> pool;
  PowerScores powers;                         ///< empty where none was chosen
  std::optional<sim::ErrorMemory> residuals;  ///< of refinements
};
/// Throws InputError.
PosteriorNotes read_posterior_notes(const ArtefactFile& artefact);

}  // namespace npdr::pipeline
