#include <optional>

#include "core/constants.h"
#include "inference/abc/abc.h"
#include "inference/abc/feature_distance.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/observation.h"
#include "pipeline/features/simulation_features.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/stages/stage_parts.h"
#include "sim/simulator_check.h"

namespace npdr::pipeline {
namespace {

// Population of the round before, and how many rows all rounds before had.
struct Previous {
  inference::AbcPopulation population;
  RowCounts rows;
  std::optional<inference::FeatureTransform> transform;
};

std::optional<Previous> read_previous(const Plan& plan, const Node& node) {
  const Index round = node.uses.front().round;
  if (round == 1) return std::nullopt;
  const Node& posterior = plan.input(node, numbered("posterior", round - 1));
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  Previous previous{read_population(file), read_posterior_notes(posterior).rows, {}};
  if (file.has("transform")) describe(Layout::reader(file), previous.transform.emplace());
  return previous;
}

// Distances of features. `transform`: that of round 1, fitted here when it is empty.
Vector euclidean_distances(const Plan& plan, const Node& node, Target target, Index num_rows,
                           std::optional<inference::FeatureTransform>& transform) {
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  const Observation observation(plan.study, std::move(target));
  const auto embedding = inference::make_embedding(method.embedding, observation.target(),
                                                   plan.study.simulator.store_every);
  const SimulationFeatures features(plan, plan.inputs(node, "simulation"), observation, *embedding);
  Vector distances = Vector::Constant(num_rows, kInfinity);
  if (features.num_rows() == 0) return distances;
  if (!transform) {
    transform = inference::fit_feature_transform(features, method.embedding.principal_components);
  }
  distances(features.rows()) =
      inference::feature_distances(features, *transform, observation.x_o(*embedding));
  return distances;
}

}  // namespace

void infer_abc(const Plan& plan, const Node& node, h5::File& file) {
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  const Node& simulation = plan.input(node, numbered("simulation", use.round));
  const Target target = read_seen_target(plan, node);
  std::optional<Previous> previous = read_previous(plan, node);

  const h5::File rows = open_simulation(plan, simulation);
  inference::AbcRound round{rows.read_matrix<double>("theta", -1, -1, h5::Values::finite), {}};
  std::optional<inference::FeatureTransform> transform;
  if (previous) transform = previous->transform;
  round.distances = method.abc.distance == inference::AbcDistance::euclidean
                        ? euclidean_distances(plan, node, target, round.theta.rows(), transform)
                        : metric_distances(plan, simulation, target, method.abc.distance);

  const inference::Prior prior(plan.study.prior);
  const auto last = previous ? std::optional(previous->population) : std::nullopt;
  const inference::AbcPopulation population =
      inference::advance(method.algorithm.kind, method.abc, prior, round, last,
                         {use.seed, "abc", use.stream_round(), 0, 0});

  RowCounts counts = previous ? previous->rows : RowCounts{};
  const Index failed = (round.distances.array() == kInfinity).count();
  counts.used += round.theta.rows() - failed;
  counts.failed += failed;
  write_particles(file, name_of(method.algorithm.kind),
                  {.prior = prior,
                   .theta = population.theta,
                   .weights = population.weights,
                   .smooth = method.abc.smooth,
                   .num_chains = population.num_chains},
                  counts);
  write_population(file, population);
  if (transform) describe(Layout::writer(file), *transform);
}

void infer_regression(const Plan& plan, const Node& node, h5::File& file) {
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  const Target target = read_seen_target(plan, node);
  const auto simulator = sim::make_simulator(plan.study.simulator);
  const auto form = simulator->regression_form();
  const Vector known = plan.source->parameters().nominal();

  const sim::RegressionRows rows = form->rows(target, known, method.linear_regression.window);
  const inference::WeightPosterior weights =
      inference::maximize_evidence(rows.regressors, rows.response);
  const Index n = method.linear_regression.num_samples;
  const RowMatrix w = weights.sample(n, {use.seed, "regression_weights", 0, 0, 0});
  RowMatrix complete(n, known.size());
  for (Index i = 0; i < n; ++i) {
    complete.row(i) = form->recover(w.row(i).transpose(), known).transpose();
  }

  const inference::Prior prior(plan.study.prior);
  const RowMatrix theta = plan.source->parameters().pick(complete);
  inference::ParticleParts parts{.prior = prior,
                                 .theta = theta,
                                 .weights = Vector::Constant(n, 1.0 / static_cast<double>(n)),
                                 .space = inference::ParticleSpace::theta};
  write_particles(file, name_of(method.algorithm.kind), parts, {});
  RegressionCounts counts{.samples = n, .weights = weights};
  for (Index i = 0; i < n; ++i) {
    if (!sim::is_possible(complete.row(i), simulator->info())) ++counts.non_physical;
    if (!prior.contains(theta.row(i).transpose())) ++counts.outside_prior;
  }
  write_part(file, counts);
}

}  // namespace npdr::pipeline
