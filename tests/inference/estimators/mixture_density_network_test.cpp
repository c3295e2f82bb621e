#include "inference/estimators/mixture_density_network.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/inference/estimators/estimator_checks.h"

namespace npdr::inference {
namespace {

EstimatorConfig small_config(Index components) {
  EstimatorConfig config;
  config.kind = EstimatorKind::mdn;
  config.num_components = components;
  config.hidden_features = 6;
  return config;
}

TEST(MixtureDensityNetwork, BackwardPassEqualsCentralDifferences) {
  for (const Index components : {1, 3}) {
    for (const Index dimension : {1, 3}) {
      ParameterLayout layout;
      const MixtureDensityNetwork<double> mdn(small_config(components), dimension, 4, layout);
      expect_gradients_of(mdn, layout.size(), 3, 2);
    }
  }
}

TEST(MixtureDensityNetwork, DensityIntegratesToOne) {
  ParameterLayout layout;
  const MixtureDensityNetwork<double> mdn(small_config(4), 2, 3, layout);
  EXPECT_NEAR(mass_on_a_grid(mdn, random_parameters(mdn, layout.size(), 2)), 1.0, 1e-6);
}

TEST(MixtureDensityNetwork, AgreesWithTheMixtureOfEachContext) {
  ParameterLayout layout;
  const MixtureDensityNetwork<double> mdn(small_config(4), 3, 3, layout);
  const Vector parameters = random_parameters(mdn, layout.size(), 2);
  const RowMatrix u = random_matrix(12, 3, 2);
  for (const Index contexts : {1, 3}) {
    const auto scratch = mdn.make_scratch();
    Vector log_prob;
    mdn.log_prob(parameters, u, random_matrix(contexts, 3, 1), *scratch, log_prob);
    const Index each = u.rows() / contexts;
    for (Index i = 0; i < contexts; ++i) {
      const GaussianMixture mixture =
          mdn.mixture(static_cast<const MixtureScratch<double>&>(*scratch), i);
      EXPECT_TRUE(mixture.log_prob(u.middleRows(i * each, each))
                      .isApprox(log_prob.segment(i * each, each), 1e-10))
          << i << " of " << contexts;
    }
  }
}

TEST(MixtureDensityNetwork, RejectsSizesBelowOne) {
  ParameterLayout layout;
  EXPECT_THROW(MixtureDensityNetwork<float>(small_config(0), 2, 2, layout), InputError);
}

}  // namespace
}  // namespace npdr::inference
