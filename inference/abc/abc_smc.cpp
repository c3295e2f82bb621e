#include "inference/abc/abc_smc.h"

#include <algorithm>
#include <cmath>

#include "core/log_sum_exp.h"
#include "core/parallel.h"
#include "inference/abc/acceptance.h"
#include "inference/abc/step_kernel.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

// w_i up to a factor: the prior's constant is left out.
Vector importance_weights(const RowMatrix& u, const RowMatrix& centers, const Vector& weights,
                          const StepKernel& kernel) {
  const Vector log_weights = weights.array().log();
  Vector result(u.rows());
  parallel_for(u.rows(), [&](Index i) {
    const RowMatrix steps = centers.rowwise() - u.row(i);
    result(i) =
        -0.5 * u.row(i).squaredNorm() - log_sum_exp(log_weights + kernel.log_density(steps));
  });
  return (result.array() - result.maxCoeff()).exp();
}

}  // namespace

Eigen::MatrixXd twice_the_covariance(const Prior& prior, const AbcPopulation& population) {
  return 2.0 * weighted_covariance(prior.to_normal(population.theta), population.weights);
}

RowMatrix propose_moved(const Prior& prior, const AbcPopulation& population, Index n,
                        const StreamId& id) {
  const StepKernel kernel(population.kernel, prior.dimension());
  const Resampler resampler(population.weights);
  const RowMatrix centers = prior.to_normal(population.theta);
  RowMatrix u(n, centers.cols());
  StreamId row = id;
  for (Index i = 0; i < n; ++i, ++row.row) {
    Stream stream(row);
    u.row(i) = centers.row(resampler.draw(stream.uniform()));
    u.row(i) += kernel.sample(stream).transpose();
  }
  return prior.to_theta(u);
}

AbcPopulation next_population(const AbcConfig& config, const Prior& prior, const AbcRound& round,
                              const AbcPopulation& previous) {
  const double quantile = accept_nearest(previous.distances, config.quantile).epsilon;
  const Accepted accepted = accept_within(round.distances, std::max(quantile, config.epsilon));
  require_enough(accepted, round.distances, prior.dimension());
  AbcPopulation next{.theta = round.theta(accepted.rows, Eigen::all),
                     .weights = {},
                     .distances = round.distances(accepted.rows),
                     .epsilon = accepted.epsilon,
                     .kernel = {}};
  const Vector weights =
      importance_weights(prior.to_normal(next.theta), prior.to_normal(previous.theta),
                         previous.weights, StepKernel(previous.kernel, prior.dimension()));
  next.weights = weights / weights.sum();
  return next;
}

}  // namespace npdr::inference
