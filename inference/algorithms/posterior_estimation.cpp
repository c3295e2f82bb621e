#include "inference/algorithms/posterior_estimation.h"

#include "core/error.h"

namespace npdr::inference {
namespace {

DirectPosteriorParts untrained_parts(const PosteriorEstimationConfig& config, const RoundData& data,
                                     const StreamId& id) {
  return {.prior = *data.prior,
          .estimator = config.estimator,
          .trained_features = config.trained_features,
          .structure_seed = id.seed,
          .transform = fit_feature_transform(*data.x, config.principal_components),
          .parameters = {},
          .x_o = data.x_o};
}

StreamId named(StreamId id, std::string_view name) {
  id.name = name;
  return id;
}

}  // namespace

std::optional<DirectPosterior> estimate_posterior(const PosteriorEstimationConfig& config,
                                                  const RoundData& data,
                                                  const DirectPosterior* previous,
                                                  const StreamId& id, TrainingState& state,
                                                  const EpochHook& hook) {
  if (canonical_algorithm(config.algorithm.name) != "npe_c") {
    throw InputError("algorithm '" + config.algorithm.name + "' doesn't estimate posteriors");
  }
  DirectPosteriorParts parts =
      previous == nullptr ? untrained_parts(config, data, id) : previous->parts();
  const EmbeddedEstimator<float> network =
      make_network(parts.estimator, parts.transform.num_outputs(), parts.trained_features,
                   parts.prior.dimension(), parts.structure_seed);
  if (state.epoch == 0 && state.parameters.size() == 0) {
    state.parameters = previous == nullptr
                           ? network.initial_parameters(named(id, "initial_weights"))
                           : parts.parameters;
  } else if (state.parameters.size() != network.num_parameters()) {
    throw ShapeError("training state: " + std::to_string(state.parameters.size()) +
                     " parameters, must be " + std::to_string(network.num_parameters()) +
                     ", as many as the network's");
  }
  TrainingData training{data.x, parts.prior.to_normal(data.theta).cast<float>(), data.round,
                        data.proposals};
  NpeC objective(config.algorithm, network, parts.transform, training, id);
  bool stopped = false;
  train(objective, config.training, id, state, [&](const TrainingState& s) {
    stopped = !hook(s);
    return !stopped;
  });
  if (stopped && !state.finished(config.training)) return std::nullopt;
  parts.parameters = state.best_parameters;
  return DirectPosterior(std::move(parts));
}

RowMatrix propose(const PosteriorEstimationConfig& config, const DirectPosterior& posterior,
                  Index n, const StreamId& id) {
  if (resolve_loss(config.algorithm, config.estimator) != "analytic") {
    return posterior.sample(n, id);
  }
  const GaussianMixture mixture = proposal_mixture(posterior);
  RowMatrix u(n, posterior.prior().dimension());
  for (Index i = 0; i < n; ++i) {
    StreamId row = id;
    row.row += static_cast<std::uint64_t>(i);
    Stream stream(row);
    u.row(i) = mixture.sample(stream).transpose();
  }
  return posterior.prior().to_theta(u);
}

GaussianMixture proposal_mixture(const DirectPosterior& posterior) {
  return narrower_than_prior(posterior.mixture());
}

}  // namespace npdr::inference
