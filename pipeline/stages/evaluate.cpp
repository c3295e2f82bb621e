#include "pipeline/artefacts/evaluation_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/predictions/judge.h"
#include "pipeline/predictions/scores.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Of the likelihood in a posterior that was refined.
double power_of(const Node& posterior) {
  const auto certificate = read_certificate(open_artefact(posterior, kPosteriorSchema));
  return certificate ? certificate->power : 1.0;
}

// Simulates the posterior's samples. `power`: of the likelihood in it.
void predict(const Plan& plan, const Judge& judge, double power, const StreamId& first,
             Evaluation& evaluation) {
  const Predictor& predictor = judge.seen();
  if (!plan.study.source().simulates) return;
  const RowMatrix complete = plan.source->parameters().complete(evaluation.theta);
  const sim::Trajectories seen = predictor.simulate(complete, first);
  const sim::Trajectories held_out = judge.simulate_held_out(complete, first);
  evaluation.metrics = judge.measure(seen, held_out);
  if (!plan.study.source().gives_motion) {
    evaluation.x = features_of(seen);
    return;
  }
  evaluation.bands = analysis::quantile_bands(view_of(seen));
  const NoiseOfSamples noise = draw_noise(plan, predictor.target(), seen, power, first);
  evaluation.scores = score(plan, judge, seen, held_out, noise, first);
}

}  // namespace

void run_evaluate(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kEvaluationSchema, node.identity);
  const Use& use = node.uses.front();
  const std::uint64_t round = use.stream_round();
  const auto posterior = read_posterior(*plan.inputs(node, Stage::infer).front());
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
  predict(plan, judge, power_of(*plan.inputs(node, Stage::infer).front()),
          {use.seed, "external_prediction", round, 0, 0}, evaluation);

  evaluation.map_theta = posterior->map({use.seed, "map", round, 0, 0});
  const RowMatrix map_row = evaluation.map_theta.transpose();
  evaluation.map_log_prob = posterior->log_prob(map_row)(0);
  evaluation.map_metrics = judge.measure_one(parameters.complete(map_row).transpose(),
                                             {use.seed, "external_map", round, 0, 0});

  if (plan.source->has_nominal()) evaluation.nominal_log_prob = log_prob_at({});
  if (const auto& truth = plan.study.target.truth) evaluation.truth_log_prob = log_prob_at(*truth);
  for (const ReferenceConfig& reference : plan.study.references) {
    evaluation.reference_log_prob[reference.name] = log_prob_at(reference.parameters);
  }
  write_evaluation(writer.file(), plan.study, evaluation);
  writer.finish();
}

}  // namespace npdr::pipeline
