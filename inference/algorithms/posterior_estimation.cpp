#include "inference/algorithms/posterior_estimation.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/algorithms/component_growth.h"
#include "inference/algorithms/npe_nle.h"
#include "inference/algorithms/pool_powers.h"
#include "inference/algorithms/round_task.h"
#include "inference/ensemble.h"
#include "inference/pooled_posterior.h"

namespace npdr::inference {
namespace {

EstimatorConfig estimator_of_round(const PosteriorEstimationConfig& config, const RoundData& data) {
  EstimatorConfig estimator = config.estimator;
  const bool is_last = std::ssize(data.posteriors) + 1 >= config.algorithm.num_rounds;
  const bool grows = traits_of(config.algorithm.kind).grows_in_last_round;
  if (grows && !is_last) estimator.num_components = 1;
  return estimator;
}

// What a network is given as x may be there twice; the density of x must not, nor components, nor
// series.
Tails tails_of(const PosteriorEstimationConfig& config, NetworkRole role) {
  const bool may_be_twice = role != NetworkRole::likelihood && config.principal_components == 0 &&
                            config.embedding.features == 0;
  return config.tails == Tails::compressed && may_be_twice ? Tails::both : config.tails;
}

// Parts that `data` and the last round's posterior give: all but the weights.
NetworkParts untrained_parts(const PosteriorEstimationConfig& config, const RoundData& data,
                             const StreamId& id) {
  const AlgorithmTraits& traits = traits_of(config.algorithm.kind);
  NetworkParts parts{.prior = *data.prior,
                     .of_role = role_parts(traits.role),
                     .estimator = estimator_of_round(config, data),
                     .structure_seed = id.seed,
                     .transform = {},
                     .parameters = {},
                     .x_o = data.x_o};
  auto* const direct = std::get_if<DirectParts>(&parts.of_role);
  if (direct != nullptr) {
    direct->embedding = config.embedding;
  } else {
    std::get<SurrogateParts>(parts.of_role).sampler = config.sampler;
  }
  if (data.posteriors.empty()) {
    parts.transform =
        fit_feature_transform(*data.x, config.principal_components, tails_of(config, traits.role));
    if (traits.role == NetworkRole::likelihood) {
      parts.transform = varying_outputs(parts.transform, *data.x);
    }
    return parts;
  }
  const NetworkPosterior& previous = *data.posteriors.back();
  parts.transform = previous.parts().transform;
  if (traits.grows_in_last_round) {
    direct->proposal = dynamic_cast<const DirectPosterior&>(previous).mixture();
  }
  return parts;
}

// Ensembles to train: the networks of the algorithm's role, and for "npe_nle" those of the
// likelihood.
std::vector<NetworkParts> untrained_ensembles(const PosteriorEstimationConfig& config,
                                              const RoundData& data, const StreamId& id) {
  std::vector<NetworkParts> ensembles = {untrained_parts(config, data, id)};
  NetworkParts& parts = ensembles.front();
  if (config.algorithm.kind != Algorithm::npe_nle || num_varying_outputs(parts.transform) == 0) {
    return ensembles;
  }
  std::get<DirectParts>(parts.of_role).likelihood = untrained_likelihood(config, data, parts);
  ensembles.push_back(likelihood_parts(parts));
  return ensembles;
}

// The network of the last round that network m of `all` begins as; all rounds have the same ones.
NetworkParts previous_network(const NetworkParts& all, const RoundData& data, Index m) {
  const NetworkParts& last = data.posteriors.back()->parts();
  const bool is_of_pool =
      last.pooled_likelihood() != nullptr && all.role() == NetworkRole::likelihood;
  return network_of(is_of_pool ? likelihood_parts(last) : last, m);
}

Parameters<float> first_weights(const PosteriorEstimationConfig& config, const RoundTask& task,
                                const NetworkParts& all, const RoundData& data, Index m,
                                const StreamId& id) {
  if (data.posteriors.empty()) return task.initial_parameters(named(id, "initial_weights"));
  const NetworkParts previous = previous_network(all, data, m);
  if (previous.estimator.num_components == all.estimator.num_components) return previous.parameters;
  return grow_components(previous, all.estimator, config.algorithm.component_perturbation,
                         named(id, "component_growth"));
}

void require_weights(const RoundTask& task, const TrainingState& state) {
  if (state.parameters.size() == task.num_parameters()) return;
  throw ShapeError("training state: " + std::to_string(state.parameters.size()) +
                   " parameters, must be " + std::to_string(task.num_parameters()) +
                   ", as many as the network's");
}

// Weights of `count` networks from `first` on, one after the other.
Parameters<float> best_weights(const std::vector<TrainingState>& states, Index first, Index count) {
  std::vector<Parameters<float>> weights;
  for (Index k = first; k < first + count; ++k) {
    weights.push_back(states[static_cast<std::size_t>(k)].best_parameters);
  }
  return joined(weights);
}

// Network m of the ensemble; false when the hook stopped it.
bool train_network(const PosteriorEstimationConfig& config, const RoundData& data,
                   const LearnedRows& learned, const NetworkParts& all, Index m, StreamId id,
                   TrainingState& state, const EpochHook& hook) {
  ValidationFold fold{id.seed, m};
  // NPE-A learns from rows that no round has seen.
  if (config.algorithm.kind != Algorithm::npe_a) fold.rows = learned.of(all.role());
  const NetworkParts parts = network_of(all, m);
  id.seed = seed_of_network(id.seed, m);
  const auto task = make_round_task(config, data, learned, parts, id);
  if (state.epoch == 0 && state.parameters.size() == 0) {
    state.parameters = first_weights(config, *task, all, data, m, id);
  }
  require_weights(*task, state);
  bool stopped = false;
  train(task->objective(), config.training, id, fold, state, [&](const TrainingState& s) {
    stopped = !hook(s);
    return !stopped;
  });
  return !stopped || state.finished(config.training);
}

}  // namespace

bool never_stop(Index, const TrainingState&) { return true; }

std::unique_ptr<NetworkPosterior> estimate_posterior(const PosteriorEstimationConfig& config,
                                                     const RoundData& data, const StreamId& id,
                                                     std::vector<TrainingState>& states,
                                                     const NetworkHook& hook) {
  check_estimator(config.algorithm.kind, config.estimator);
  std::vector<NetworkParts> ensembles = untrained_ensembles(config, data, id);
  const Index networks = config.estimator.num_networks;
  states.resize(ensembles.size() * static_cast<std::size_t>(networks));
  const bool are_pooled = ensembles.size() > 1;
  const LearnedRows learned = learned_rows(config, data, are_pooled);
  std::mutex one_at_a_time;
  std::atomic<bool> halted = false;  // by the hook, or by the error of a network
  parallel_for(std::ssize(states), [&](Index k) {
    if (halted) return;
    const auto hook_of_network = [&](const TrainingState& state) {
      const std::scoped_lock lock(one_at_a_time);
      return hook(k, state) && !halted;
    };
    try {
      const NetworkParts& ensemble = ensembles[static_cast<std::size_t>(k / networks)];
      const bool ended = train_network(config, data, learned, ensemble, k % networks, id,
                                       states[static_cast<std::size_t>(k)], hook_of_network);
      if (!ended) halted = true;
    } catch (...) {
      halted = true;
      throw;
    }
  });
  if (halted) return nullptr;
  NetworkParts& parts = ensembles.front();
  parts.parameters = best_weights(states, 0, networks);
  if (are_pooled) {
    PooledLikelihood& likelihood = *std::get<DirectParts>(parts.of_role).likelihood;
    likelihood.parameters = best_weights(states, networks, networks);
    likelihood.powers = pool_powers(parts, data, learned.judging, id);
  }
  return make_posterior(std::move(parts));
}

RowMatrix propose(const PosteriorEstimationConfig& config, const NetworkPosterior& posterior,
                  Index n, const StreamId& id) {
  if (config.algorithm.kind == Algorithm::npe_nle) return propose_for_npe_nle(posterior, n, id);
  if (!is_analytic(config.algorithm, config.estimator.kind)) return posterior.sample(n, id);
  return posterior.prior().to_theta(proposal_mixture(posterior).sample(n, id));
}

}  // namespace npdr::inference
