#include <algorithm>

#include "core/feature_names.h"
#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/observation.h"
#include "pipeline/predictions/misfit.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/predictions/scores.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// The only row, if any, `count` times.
sim::Trajectories repeat(const sim::Trajectories& one, Index count) {
  sim::Trajectories many;
  if (one.num_rows == 0) return many;
  many.resize(count, one.num_rollouts, one.num_steps, one.num_states);
  std::ranges::fill(many.status, one.status.front());
  for (Index i = 0; i < count; ++i) std::ranges::copy(one.values, many.row(i).begin());
  return many;
}

// `number`: that of the point, which names the random numbers of a simulator that draws some.
BaselinePoint measure(const Plan& plan, const Judge& judge, const std::string& name,
                      const Vector& complete, std::size_t number) {
  const PredictedRollouts predicted =
      judge.simulate(complete.transpose(), {0, "external_baseline", 0, number, 0});
  BaselinePoint point{name, plan.source->parameters().pick_one(complete),
                      judge.measure_one(predicted)};
  if (!plan.study.source().gives_motion) return point;
  // With noise, a single rollout is one of as many samples as a posterior has.
  const Index count = plan.study.evaluate.num_samples;
  const PredictedRollouts many{repeat(predicted.seen, count), repeat(predicted.held_out, count)};
  const StreamId id{0, "baseline_scores", number, 0, 0};
  point.scores = score(judge, many, draw_noise(judge.seen().observation(), many.seen, {}, id), id);
  return point;
}

PriorPredictions predict_by_prior(const Plan& plan, const Judge& judge) {
  const Index count = plan.study.evaluate.num_samples;
  const RowMatrix theta = inference::sample_prior(inference::Prior(plan.study.prior), count,
                                                  {0, "prior_predictions", 0, 0, 0});
  const StreamId id{0, "external_prior", 0, 0, 0};
  const PredictedRollouts predicted = judge.simulate(plan.source->parameters().complete(theta), id);
  PriorPredictions predictions{judge.measure(predicted)};
  if (!plan.study.source().gives_motion) return predictions;
  const NoiseOfSamples noise = draw_prior_noise(judge.seen().observation(), count, id);
  predictions.scores = score(judge, predicted, noise, id);
  return predictions;
}

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

template <>
void run<Stage::baseline>(const Plan& plan, const Node& node, const std::vector<Index>&) {
  ArtefactWriter writer(node.path, kBaselineSchema, node.identity);
  const Judge judge(plan, node);
  Baseline baseline{.points = {}, .prior = {}, .misfit = {}, .parameters = plan.study.prior};
  std::vector<BaselinePoint>& points = baseline.points;
  const auto add = [&](const std::string& name, const std::map<std::string, double>& values) {
    const Vector complete = plan.source->parameters().nominal(values);
    points.push_back(measure(plan, judge, name, complete, points.size()));
  };
  if (plan.source->has_nominal()) add("nominal", {});
  for (const ReferenceConfig& reference : plan.study.references) {
    add(reference.name, reference.parameters);
  }
  if (const auto& truth = plan.study.target.truth) {
    add("truth", *truth);
  } else if (const Node* fit = plan.find_input(node, "posterior")) {
    const RowMatrix best = read_posterior(*fit)->map({}).transpose();
    const Vector complete = plan.source->parameters().complete(best).row(0).transpose();
    points.push_back(measure(plan, judge, "floor", complete, 0));
    const std::filesystem::path log = log_of(node.path);
    baseline.misfit = find_misfit(plan, judge.seen().observation(), points.back().theta,
                                  log.parent_path() / (log.stem().string() + "-fit.log"));
  }
  if (plan.study.source().simulates) baseline.prior = predict_by_prior(plan, judge);
  kBaselineSchema.write(writer.file(), std::move(baseline));
  writer.finish();
}

template <>
void run<Stage::evaluate>(const Plan& plan, const Node& node, const std::vector<Index>&) {
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
