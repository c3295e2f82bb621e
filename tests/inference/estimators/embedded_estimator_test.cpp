#include "inference/estimators/embedded_estimator.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

TEST(EmbeddedEstimator, BackwardPassEqualsCentralDifferencesThroughTheLinearLayer) {
  for (const EstimatorKind kind : kinds_that_give(Estimate::density)) {
    for (const Index features : {0, 4}) {
      EstimatorConfig config;
      config.kind = kind;
      config.num_transforms = 2;
      config.num_components = 3;
      config.hidden_features = 5;
      const EmbeddedEstimator<double> network(6, {features}, config, 3, {1, "structure", 0, 0, 0});
      Vector parameters = network.initial_parameters({2, "initial", 0, 0, 0});
      const RowMatrix u = random_matrix(8, 3, 1);
      const RowMatrix x = random_matrix(4, 6, 2);
      auto scratch = network.make_scratch();
      Vector log_prob;
      network.log_prob(parameters, u, x, scratch, log_prob);
      Vector gradient = Vector::Zero(network.num_parameters());
      network.backward(parameters, u, x, Vector::Ones(8), scratch, gradient);
      const Vector at = parameters;
      expect_gradient(
          [&](const Vector& p) {
            // Masked weights, and nothing else, are zero, and never move.
            network.log_prob((at.array() == 0.0).select(0.0, p), u, x, scratch, log_prob);
            return log_prob.sum();
          },
          at, gradient);
    }
  }
}

TEST(EmbeddedEstimator, RejectsAKindWithoutADensity) {
  for (const EstimatorKind kind : kinds_that_give(Estimate::ratio)) {
    const EstimatorConfig config{.kind = kind};
    EXPECT_THROW(EmbeddedEstimator<float>(2, {}, config, 2, {1, "structure", 0, 0, 0}), InputError);
  }
}

}  // namespace
}  // namespace npdr::inference
