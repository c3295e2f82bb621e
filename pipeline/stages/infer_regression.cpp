#include "pipeline/artefacts/particle_file.h"
#include "pipeline/features/observation.h"
#include "pipeline/stages/infer_methods.h"
#include "sim/simulator_check.h"

namespace npdr::pipeline {
namespace {

RegressionCounts count(const inference::Prior& prior, const sim::SimulatorInfo& info,
                       const RowMatrix& complete, const RowMatrix& theta) {
  RegressionCounts counts{.samples = theta.rows()};
  for (Index i = 0; i < theta.rows(); ++i) {
    if (!sim::is_possible(complete.row(i), info)) ++counts.non_physical;
    if (!prior.contains(theta.row(i).transpose())) ++counts.outside_prior;
  }
  return counts;
}

}  // namespace

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
  RegressionCounts counts = count(prior, simulator->info(), complete, theta);
  counts.weights = weights;
  write_part(file, counts);
}

}  // namespace npdr::pipeline
