/// Settings of an inference algorithm, as a study gives them.
#pragma once

#include <string>
#include <vector>

#include "core/types.h"
#include "inference/network_posterior.h"

namespace npdr::inference {

struct AlgorithmConfig {
  std::string name = "npe_c";  ///< a name of algorithm_names(), or an older spelling (snpe_c, apt)
  Index num_rounds = 1;
  Index num_simulations = 1000;  ///< per round
  Index num_atoms = 10;          ///< "npe_c", "nre_b": theta compared per x, the true one included
  std::string loss = "auto";     ///< "npe_c": "auto", "atomic" or "analytic" (mdn only)
  double component_perturbation =
      0.01;                    ///< "npe_a": of the weights, when one Gaussian becomes many
  bool combined_loss = false;  ///< "npe_c": add -log q on the rows of the prior, when atomic
};

/// "npe_a", "npe_b", "npe_c", "nle", "nre_a", "nre_b" (posterior_estimation.h), "abc_rejection",
/// "abc_mcmc", "abc_smc" (abc.h), "linear_regression" (bayesian_linear_regression.h), and two that
/// infer nothing and are there to be compared with: "prior" keeps the prior (domain randomisation),
/// "nominal" the nominal parameters.
std::vector<std::string> algorithm_names();

/// What an algorithm makes its posterior of.
enum class AlgorithmFamily {
  network,     ///< a network that is trained on simulations
  abc,         ///< the simulations that are near the observation
  regression,  ///< the equations of motion and the recordings, no simulation
  fixed,       ///< nothing: what is known before any observation
};
AlgorithmFamily family_of_algorithm(const std::string& name);

/// What the algorithm's network says (network_posterior.h). Throws Error for one that has none.
NetworkRole role_of_algorithm(const std::string& name);

/// The kinds of density estimators that the algorithm can use, the usual one first; none without a
/// network.
std::vector<std::string> estimators_of_algorithm(const std::string& name);

/// Throws InputError for another kind, and says which are allowed.
void check_estimator(const std::string& algorithm, const EstimatorConfig& estimator);

/// The name of algorithm_names() that `spelling` stands for ("snpe_c" and "apt" are "npe_c",
/// "bayessim" and "snpe_a" are "npe_a", ...); throws InputError with the nearest known name.
std::string canonical_algorithm(const std::string& spelling);

}  // namespace npdr::inference
