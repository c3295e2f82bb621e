#include "inference/algorithms/algorithm_config.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/text.h"

namespace npdr::inference {
namespace {

constexpr std::array kMixtures = {EstimatorKind::mdn};
constexpr std::array kDensities = {EstimatorKind::nsf, EstimatorKind::maf, EstimatorKind::mdn};
constexpr std::array kRatios = {EstimatorKind::resnet};

using A = Algorithm;
using F = AlgorithmFamily;
using R = NetworkRole;

// Every algorithm. To add one that trains a network, write its Objective, a case for it in
// round_task.cpp, and a row here. Other spellings are those of older papers and tools.
constexpr std::array kAlgorithms = std::to_array<AlgorithmTraits>({
    {{A::npe_nle, "npe_nle"}, F::network, R::posterior, kDensities},
    {{A::npe_a, "npe_a", "snpe_a snpe-a bayessim"}, F::network, R::posterior, kMixtures, true},
    {{A::npe_b, "npe_b", "snpe_b snpe-b"}, F::network, R::posterior, kDensities},
    {{A::npe_c, "npe_c", "snpe_c snpe-c apt"}, F::network, R::posterior, kDensities},
    {{A::nle, "nle", "snle"}, F::network, R::likelihood, kDensities},
    {{A::nre_a, "nre_a", "aalr snre_a"}, F::network, R::ratio, kRatios},
    {{A::nre_b, "nre_b", "snre_b"}, F::network, R::ratio, kRatios},
    {{A::abc_rejection, "abc_rejection", "abc rejection_abc mcabc"},
     F::abc,
     R::posterior,
     {},
     false,
     true},
    {{A::abc_mcmc, "abc_mcmc", "mcmc_abc"}, F::abc},
    {{A::abc_smc, "abc_smc", "smc_abc"}, F::abc},
    {{A::linear_regression, "linear_regression", "blr bayesian_linear_regression"}, F::regression},
    {{A::refine, "refine", "importance_sampling exact"}, F::likelihood},
    {{A::prior, "prior", "domain_randomization"}, F::fixed},
    {{A::nominal, "nominal"}, F::fixed},
});

}  // namespace

std::span<const AlgorithmTraits> enum_table(Algorithm /*algorithm*/) { return kAlgorithms; }

const AlgorithmTraits& traits_of(Algorithm algorithm) {
  return *std::ranges::find(kAlgorithms, algorithm, &AlgorithmTraits::value);
}

std::string estimator_list(const AlgorithmTraits& traits) {
  std::vector<std::string> names;
  for (const EstimatorKind kind : traits.estimators) names.push_back(name_of(kind));
  return join(names);
}

bool allows_ensembles(const AlgorithmTraits& traits) {
  return !traits.grows_in_last_round && traits.role != NetworkRole::ratio;
}

void check_estimator(Algorithm algorithm, const EstimatorConfig& estimator) {
  const AlgorithmTraits& traits = traits_of(algorithm);
  const std::string with = " with algorithm '" + name_of(algorithm) + "'";
  if (std::ranges::count(traits.estimators, estimator.kind) == 0) {
    throw InputError("density_estimator.kind = '" + name_of(estimator.kind) + "', must be one of " +
                     estimator_list(traits) + with);
  }
  if (estimator.num_networks > 1 && !allows_ensembles(traits)) {
    throw InputError("density_estimator.num_networks = " + std::to_string(estimator.num_networks) +
                     ", must be 1" + with);
  }
}

Loss resolve_loss(const AlgorithmConfig& config, EstimatorKind estimator) {
  const bool is_mixture = estimator == EstimatorKind::mdn;
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
