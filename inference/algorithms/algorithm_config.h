/// The inference algorithms, and their settings as a study gives them.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/enum_names.h"
#include "core/types.h"
#include "inference/network_posterior.h"

namespace npdr::inference {

enum class Algorithm {
  npe_nle,  ///< this and the next six: posterior_estimation.h
  npe_a,
  npe_b,
  npe_c,
  nle,
  nre_a,
  nre_b,
  abc_rejection,  ///< this and the next two: abc.h
  abc_mcmc,
  abc_smc,
  linear_regression,  ///< bayesian_linear_regression.h
  least_squares,      ///< least_squares.h
  refine,             ///< importance_sampler.h
  prior,              ///< infers nothing, to be compared with: domain randomization over the prior
  nominal,            ///< infers nothing, either: the nominal parameters
};

/// Origin of an algorithm's posterior.
enum class AlgorithmFamily {
  network,     ///< a network that is trained on simulations
  abc,         ///< the simulations that are near the observation
  regression,  ///< the equations of motion and the recordings, no simulation
  likelihood,  ///< the likelihood of the observation noise, at simulations that it asks for
  fit,         ///< simulations that it fits to the observation
  fixed,       ///< nothing: what is known before any observation
};

/// Everything about an algorithm that others than its own files need.
struct AlgorithmTraits : EnumRow<Algorithm> {
  AlgorithmFamily family;
  NetworkRole role = NetworkRole::posterior;  ///< of a network
  Estimate estimate = Estimate::density;      ///< that the network must give
  /// One Gaussian is the network until the last round, which grows it to a mixture; posteriors are
  /// divided by their proposal.
  bool grows_in_last_round = false;
  bool has_one_round = false;  ///< all simulations come from the prior
};

/// Every algorithm, in the documented order.
std::span<const AlgorithmTraits> enum_table(Algorithm);
const AlgorithmTraits& traits_of(Algorithm algorithm);

/// The kinds of density estimators that it can use, the usual one first; none without a network.
std::vector<EstimatorKind> estimators_of(const AlgorithmTraits& traits);
/// "nsf, maf, mdn": their names.
std::string estimator_list(const AlgorithmTraits& traits);

/// NPE-C's correction for proposals that aren't the prior (npe_c.h).
enum class Loss { automatic, atomic, analytic };
constexpr auto enum_table(Loss) {
  using enum Loss;
  return std::to_array<EnumRow<Loss>>(
      {{automatic, "auto"}, {atomic, "atomic"}, {analytic, "analytic"}});
}

struct AlgorithmConfig {
  Algorithm kind = Algorithm::npe_c;
  Index num_rounds = 1;
  Index num_simulations = 1000;  ///< per round
  Index num_atoms = 10;          ///< "npe_c", "nre_b": theta compared per x, the true one included
  Loss loss = Loss::automatic;   ///< "npe_c"; analytic with "mdn" only
  double component_perturbation =
      0.01;                    ///< "npe_a": of the weights, when one Gaussian becomes many
  bool combined_loss = false;  ///< "npe_c": add -log q on the rows of the prior, when atomic
};

/// Whether the algorithm's posterior may be the mean of several networks': not where it is divided
/// by a single Gaussian, nor where each network's ratio has a constant of its own (ratio_loss.h).
bool allows_ensembles(const AlgorithmTraits& traits);

/// Throws InputError for a kind, or a number of networks, that the algorithm can't use, and says
/// which it can.
void check_estimator(Algorithm algorithm, const EstimatorConfig& estimator);

/// The loss that NPE-C has with this estimator: "auto" is analytic for a mixture and atomic
/// otherwise. Throws InputError for "analytic" with another estimator.
Loss resolve_loss(const AlgorithmConfig& config, EstimatorKind estimator);

/// Whether the algorithm is NPE-C with the analytic loss. Throws as resolve_loss().
bool is_analytic(const AlgorithmConfig& config, EstimatorKind estimator);

}  // namespace npdr::inference
