#include "inference/in_memory.h"

#include <optional>

#include "inference/abc/abc.h"
#include "inference/abc/feature_distance.h"
#include "inference/matrix_features.h"

namespace npdr::inference {

RowMatrixF simulate(const SimulatorFunction& simulator, const RowMatrix& theta, std::uint64_t seed,
                    std::uint64_t round) {
  RowMatrixF x;
  for (Index i = 0; i < theta.rows(); ++i) {
    Stream stream({seed, "simulate", round, static_cast<std::uint64_t>(i), 0});
    const VectorF row = simulator(theta.row(i).transpose(), stream);
    if (i == 0) x.resize(theta.rows(), row.size());
    x.row(i) = row.transpose();
  }
  return x;
}

std::shared_ptr<const NetworkPosterior> infer(const PosteriorEstimationConfig& config,
                                              const Prior& prior,
                                              const SimulatorFunction& simulator,
                                              const VectorF& x_o, std::uint64_t seed) {
  RoundData data;
  data.prior = &prior;
  data.x_o = x_o;
  RowMatrixF x(0, x_o.size());
  std::shared_ptr<const NetworkPosterior> posterior;
  const Index n = config.algorithm.num_simulations;
  for (Index round = 1; round <= config.algorithm.num_rounds; ++round) {
    const auto r = static_cast<std::uint64_t>(round);
    const RowMatrix theta = posterior ? propose(config, *posterior, n, {seed, "propose", r, 0, 0})
                                      : sample_prior(prior, n, seed);
    if (posterior) data.posteriors.push_back(posterior);
    x.conservativeResize(x.rows() + n, Eigen::NoChange);
    x.bottomRows(n) = simulate(simulator, theta, seed, r);
    data.theta.conservativeResize(x.rows(), prior.dimension());
    data.theta.bottomRows(n) = theta;
    data.round.insert(data.round.end(), static_cast<std::size_t>(n),
                      static_cast<std::uint32_t>(round));
    const MatrixFeatures source(x);
    data.x = &source;
    std::vector<TrainingState> states;
    posterior = estimate_posterior(config, data, {seed, "train", r, 0, 0}, states, never_stop);
  }
  return posterior;
}

std::shared_ptr<const ParticlePosterior> infer_abc(const AlgorithmConfig& algorithm,
                                                   const AbcConfig& config, const Prior& prior,
                                                   const SimulatorFunction& simulator,
                                                   const VectorF& x_o, std::uint64_t seed) {
  std::optional<AbcPopulation> population;
  FeatureTransform transform;
  const Index n = algorithm.num_simulations;
  for (Index round = 1; round <= algorithm.num_rounds; ++round) {
    const auto r = static_cast<std::uint64_t>(round);
    const RowMatrix theta =
        population ? propose(algorithm.kind, prior, *population, n, {seed, "propose", r, 0, 0})
                   : sample_prior(prior, n, seed);
    const RowMatrixF x = simulate(simulator, theta, seed, r);
    const MatrixFeatures source(x);
    if (!population) transform = fit_feature_transform(source, 0);
    const AbcRound simulations{theta, feature_distances(source, transform, x_o)};
    population =
        advance(algorithm.kind, config, prior, simulations, population, {seed, "abc", r, 0, 0});
  }
  return std::make_shared<const ParticlePosterior>(
      ParticleParts{.prior = prior,
                    .theta = population->theta,
                    .weights = population->weights,
                    .smooth = config.smooth,
                    .num_chains = population->num_chains});
}

}  // namespace npdr::inference
