#include "inference/algorithms/algorithm_config.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/text.h"

namespace npdr::inference {
namespace {

using A = Algorithm;
using E = Estimate;
using F = AlgorithmFamily;
using R = NetworkRole;

// Every algorithm. To add one that trains a network, write its Objective, a case for it in
// round_task.cpp, and a row here. Other spellings are those of older papers and tools.
constexpr std::array kAlgorithms = std::to_array<AlgorithmTraits>({
    {{A::npe_nle, "npe_nle"}, F::network, R::posterior, E::density},
    {{A::npe_a, "npe_a", "snpe_a snpe-a bayessim"}, F::network, R::posterior, E::mixture, true},
    {{A::npe_b, "npe_b", "snpe_b snpe-b"}, F::network, R::posterior, E::density},
    {{A::npe_c, "npe_c", "snpe_c snpe-c apt"}, F::network, R::posterior, E::density},
    {{A::nle, "nle", "snle"}, F::network, R::likelihood, E::density},
    {{A::nre_a, "nre_a", "aalr snre_a"}, F::network, R::ratio, E::ratio},
    {{A::nre_b, "nre_b", "snre_b"}, F::network, R::ratio, E::ratio},
    {{A::abc_rejection, "abc_rejection", "abc rejection_abc mcabc"},
     F::abc,
     R::posterior,
     E::density,
     false,
     true},
    {{A::abc_mcmc, "abc_mcmc", "mcmc_abc"}, F::abc},
    {{A::abc_smc, "abc_smc", "smc_abc"}, F::abc},
    {{A::linear_regression, "linear_regression", "blr bayesian_linear_regression"}, F::regression},
    {{A::least_squares, "least_squares", "nlls robust_least_squares"}, F::fit},
    {{A::refine, "refine", "importance_sampling exact"}, F::likelihood},
    {{A::prior, "prior", "domain_randomization"}, F::fixed},
    {{A::nominal, "nominal"}, F::fixed},
});

}  // namespace

std::span<const AlgorithmTraits> enum_table(Algorithm /*algorithm*/) { return kAlgorithms; }

const AlgorithmTraits& traits_of(Algorithm algorithm) {
  return *std::ranges::find(kAlgorithms, algorithm, &AlgorithmTraits::value);
}

std::vector<EstimatorKind> estimators_of(const AlgorithmTraits& traits) {
  if (traits.family != F::network) return {};
  std::vector<EstimatorKind> kinds = kinds_that_give(traits.estimate);
  std::ranges::stable_partition(kinds,
                                [](EstimatorKind kind) { return kind == EstimatorConfig{}.kind; });
  return kinds;
}

std::string estimator_list(const AlgorithmTraits& traits) {
  return join(to_names(estimators_of(traits)));
}

bool allows_ensembles(const AlgorithmTraits& traits) {
  return !traits.grows_in_last_round && traits.role != NetworkRole::ratio;
}

void check_estimator(Algorithm algorithm, const EstimatorConfig& estimator) {
  const AlgorithmTraits& traits = traits_of(algorithm);
  const std::string with = " with algorithm '" + name_of(algorithm) + "'";
  if (std::ranges::count(estimators_of(traits), estimator.kind) == 0) {
    throw InputError("density_estimator.kind = '" + name_of(estimator.kind) + "', must be one of " +
                     estimator_list(traits) + with);
  }
  if (estimator.num_networks > 1 && !allows_ensembles(traits)) {
    throw InputError("density_estimator.num_networks = " + std::to_string(estimator.num_networks) +
                     ", must be 1" + with);
  }
}

Loss resolve_loss(const AlgorithmConfig& config, EstimatorKind estimator) {
  const bool is_mixture = traits_of(estimator).gives(Estimate::mixture);
  if (config.loss == Loss::analytic && !is_mixture) {
    throw InputError("loss = 'analytic' needs density_estimator.kind = 'mdn', found '" +
                     name_of(estimator) + "'; use 'atomic' or 'auto'");
  }
  if (config.loss == Loss::automatic) return is_mixture ? Loss::analytic : Loss::atomic;
  return config.loss;
}

bool is_analytic(const AlgorithmConfig& config, EstimatorKind estimator) {
  return config.kind == Algorithm::npe_c && resolve_loss(config, estimator) == Loss::analytic;
}

}  // namespace npdr::inference
