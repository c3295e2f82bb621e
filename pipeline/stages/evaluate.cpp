#include "core/feature_names.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/observation.h"
#include "pipeline/predictions/scores.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Simulates the posterior's samples.
void predict(const Plan& plan, const Node& node, const Judge& judge, const StreamId& first,
             Evaluation& evaluation) {
  const SourceTraits& source = plan.study.source();
  const PredictedRollouts predicted =
      judge.simulate(plan.source->parameters().complete(evaluation.theta), first);
  evaluation.metrics = judge.measure(predicted);
  if (source.predicts_features()) evaluation.x = features_of(predicted.seen);
  if (!source.gives_motion) return;
  evaluation.bands = analysis::quantile_bands(view_of(predicted.seen));
  if (judge.held_out() != nullptr) {
    evaluation.held_out_bands = analysis::quantile_bands(view_of(predicted.held_out));
  }
  // Not what the posterior has seen in all iterations: evaluations are by the first target.
  const std::string& method = node.uses.front().method;
  const Observation observation(plan.study,
                                read_target(plan, node, plan.study.method(method).num_rollouts));
  const NoiseOfSamples noise = draw_noise(observation, predicted.seen,
                                          noise_source(plan, plan.input(node, "posterior")), first);
  evaluation.noise = inferred_noise(observation.noise(), noise, predicted.seen);
  evaluation.scores = score(judge, predicted, noise, first);
}

}  // namespace

void run_evaluate(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kEvaluationSchema, node.identity);
  const Use& use = node.uses.front();
  const std::uint64_t round = use.stream_round();
  const auto posterior = read_posterior(plan.input(node, "posterior"));
  const Judge judge(plan, node);
  const ParameterMap& parameters = plan.source->parameters();
  const auto log_prob_at = [&](const std::map<std::string, double>& values) {
    return posterior->log_prob(parameters.pick_one(parameters.nominal(values)).transpose())(0);
  };

  Evaluation evaluation;
  inference::Samples samples =
      posterior->draw(plan.study.evaluate.num_samples, {use.seed, "posterior", round, 0, 0});
  evaluation.theta = std::move(samples.theta);
  evaluation.sampler = std::move(samples.report);
  evaluation.log_prob = posterior->log_prob(evaluation.theta);
  predict(plan, node, judge, {use.seed, "external_prediction", round, 0, 0}, evaluation);

  evaluation.map_theta = posterior->map({use.seed, "map", round, 0, 0});
  const RowMatrix map_row = evaluation.map_theta.transpose();
  evaluation.map_log_prob = posterior->log_prob(map_row)(0);
  evaluation.map_metrics = judge.measure_one(
      judge.simulate(parameters.complete(map_row), {use.seed, "external_map", round, 0, 0}));

  if (plan.source->has_nominal()) evaluation.nominal_log_prob = log_prob_at({});
  if (const auto& truth = plan.study.target.truth) evaluation.truth_log_prob = log_prob_at(*truth);
  for (const ReferenceConfig& reference : plan.study.references) {
    evaluation.reference_log_prob[reference.name] = log_prob_at(reference.parameters);
  }
  evaluation.parameters = plan.study.prior;
  evaluation.features = parse_features(plan.study.external.features);
  kEvaluationSchema.write(writer.file(), std::move(evaluation));
  writer.finish();
}

}  // namespace npdr::pipeline
