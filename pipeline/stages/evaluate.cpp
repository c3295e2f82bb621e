#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/stages/evaluation_file.h"
#include "pipeline/stages/judge.h"
#include "pipeline/stages/posterior_file.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Simulates the posterior's samples; of a dataset nothing can be predicted.
void predict(const Plan& plan, const Judge& judge, const StreamId& first, Evaluation& evaluation) {
  const Predictor& predictor = judge.seen();
  if (plan.study.external.dataset) return;
  const RowMatrix complete = predictor.complete(evaluation.theta);
  const sim::Trajectories trajectories = predictor.simulate(complete, first);
  evaluation.metrics = judge.measure(complete, trajectories);
  if (plan.study.external.command) {
    evaluation.x = features_of(trajectories);
  } else {
    evaluation.bands = analysis::quantile_bands(view_of(trajectories));
  }
}

}  // namespace

void run_evaluate(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kEvaluationSchema, node.identity);
  const Use& use = node.uses.front();
  const std::uint64_t round = use.stream_round();
  const auto posterior = read_posterior(*plan.inputs(node, Stage::infer).front());
  const Judge judge(plan, node);
  const Predictor& predictor = judge.seen();
  const auto log_prob_of = [&](const Vector& complete) {
    return posterior->log_prob(predictor.pick(complete).transpose())(0);
  };

  Evaluation evaluation;
  inference::Samples samples =
      posterior->draw(plan.study.evaluate.num_samples, {use.seed, "posterior", round, 0, 0});
  evaluation.theta = std::move(samples.theta);
  evaluation.sampler = std::move(samples.report);
  evaluation.log_prob = posterior->log_prob(evaluation.theta);
  predict(plan, judge, {use.seed, "external_prediction", round, 0, 0}, evaluation);

  evaluation.map_theta = posterior->map({use.seed, "map", round, 0, 0});
  const RowMatrix map_row = evaluation.map_theta.transpose();
  evaluation.map_log_prob = posterior->log_prob(map_row)(0);
  evaluation.map_metrics = judge.measure_one(predictor.complete(map_row).transpose(),
                                             {use.seed, "external_map", round, 0, 0});

  if (!plan.study.external.is_used()) {
    evaluation.nominal_log_prob = log_prob_of(predictor.nominal());
  }
  if (plan.study.target.truth) evaluation.truth_log_prob = log_prob_of(predictor.truth());
  for (const ReferenceConfig& reference : plan.study.references) {
    evaluation.reference_log_prob[reference.name] =
        log_prob_of(predictor.nominal_with(reference.parameters));
  }
  write_evaluation(writer.file(), plan, evaluation);
  writer.finish();
}

}  // namespace npdr::pipeline
