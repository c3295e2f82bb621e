#include "inference/log_normalizer.h"

#include <cmath>

#include "core/log_sum_exp.h"
#include "inference/estimators/gaussian_mixture.h"
#include "inference/weighted_population.h"

namespace npdr::inference {

double log_normalizer(const LogDensity& log_density, const RowMatrix& samples, const StreamId& id) {
  constexpr Index num_points = 20'000;
  constexpr double wider = 1.5, prior_share = 0.1;
  const Index d = samples.cols();
  const Eigen::RowVectorXd mean = samples.colwise().mean();
  const RowMatrix centered = samples.rowwise() - mean;
  const Eigen::MatrixXd covariance =
      wider * wider * (centered.transpose() * centered) / static_cast<double>(samples.rows() - 1) +
      1e-10 * Eigen::MatrixXd::Identity(d, d);
  GaussianMixture around{Vector(2),
                         {mean.transpose(), Vector::Zero(d)},
                         {precision_factor(covariance), Eigen::MatrixXd::Identity(d, d)}};
  around.log_weights << std::log(1.0 - prior_share), std::log(prior_share);
  const RowMatrix points = around.sample(num_points, id);
  return log_mean_exp(numbers(log_density(points) - around.log_prob(points)));
}

}  // namespace npdr::inference
