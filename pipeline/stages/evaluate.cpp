#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/stages/evaluation_file.h"
#include "pipeline/stages/posterior_file.h"
#include "pipeline/stages/prediction.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {

void run_evaluate(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kEvaluationSchema, node.identity);
  const Use& use = node.uses.front();
  const auto round = static_cast<std::uint64_t>(use.round);
  const inference::DirectPosterior posterior =
      read_posterior(*plan.inputs(node, Stage::infer).front());
  const Predictor predictor(plan, read_target(plan, node));

  Evaluation evaluation;
  evaluation.theta =
      posterior.sample(plan.study.evaluate.num_samples, {use.seed, "posterior", round, 0, 0});
  evaluation.log_prob = posterior.log_prob(evaluation.theta);
  const sim::Trajectories trajectories = predictor.simulate(evaluation.theta);
  evaluation.metrics = predictor.measure(trajectories);
  evaluation.bands = analysis::quantile_bands(view_of(trajectories));

  evaluation.map_theta = posterior.map({use.seed, "map", round, 0, 0});
  const RowMatrix map_row = evaluation.map_theta.transpose();
  evaluation.map_log_prob = posterior.log_prob(map_row)(0);
  for (const auto& [metric, values] : predictor.measure(predictor.simulate(map_row))) {
    evaluation.map_metrics[metric] = values(0);
  }
  evaluation.nominal_log_prob = posterior.log_prob(predictor.nominal().transpose())(0);
  if (plan.study.target.truth) {
    evaluation.truth_log_prob = posterior.log_prob(predictor.truth().transpose())(0);
  }
  write_evaluation(writer.file(), plan, evaluation);
  writer.finish();
}

}  // namespace npdr::pipeline
