#include "inference/algorithms/npe_nle.h"

#include <gtest/gtest.h>

#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

// One parameter, of which `telling` features say the same with noise, and others nothing.
SimulatorFunction simulator(Index num_features, Index telling) {
  return [=](const Vector& theta, Stream& stream) {
    VectorF x(num_features);
    for (float& value : x) value = static_cast<float>(stream.normal());
    x.head(telling).array() += static_cast<float>(3.0 * theta(0));
    return x;
  };
}

class PooledLikelihoodOf : public ::testing::Test {
 protected:
  PooledLikelihood likelihood(const SimulatorFunction& simulate, Index num_features) const {
    const Prior prior({{"a", "1", Marginal::Kind::normal, 0.0, 1.0}});
    const auto posterior = infer(config_, prior, simulate, VectorF::Zero(num_features), 1);
    EXPECT_EQ(posterior->parts().estimator.kind, config_.estimator.kind);
    return *posterior->parts().pooled_likelihood();
  }
  PooledLikelihood likelihood(Index num_features, Index telling) const {
    return likelihood(simulator(num_features, telling), num_features);
  }

  PosteriorEstimationConfig config_ = [] {
    PosteriorEstimationConfig c = small_config(Algorithm::npe_nle, EstimatorKind::nsf, 1, 100);
    c.training.max_epochs = 2;
    return c;
  }();
};

constexpr Index kMany = kMostPooledFeatures + 1;

TEST_F(PooledLikelihoodOf, FewFeaturesSeesThemAll) {
  const PooledLikelihood all = likelihood(kMostPooledFeatures, 1);
  EXPECT_EQ(all.transform.num_outputs(), kMostPooledFeatures);
  EXPECT_EQ(all.estimator.kind, EstimatorKind::nsf);
}

TEST_F(PooledLikelihoodOf, FewFeaturesOfWhichOneIsConstantSeesTheOthersBySplines) {
  const SimulatorFunction constant = [](const Vector& theta, Stream& stream) -> VectorF {
    VectorF x = simulator(4, 4)(theta, stream);
    x(2) = 0.5F;
    return x;
  };
  const PooledLikelihood three = likelihood(constant, 4);
  EXPECT_EQ(three.transform.num_outputs(), 3);
  EXPECT_EQ(three.estimator.kind, EstimatorKind::nsf);
}

TEST_F(PooledLikelihoodOf, ManyFeaturesSeesThoseThatTell) {
  const PooledLikelihood two = likelihood(kMany, 2);
  ASSERT_EQ(two.transform.num_outputs(), 2);
  EXPECT_EQ(two.transform.basis.topRows(2), RowMatrixF::Identity(2, 2));
  EXPECT_EQ(two.estimator.kind, EstimatorKind::nsf);
}

TEST_F(PooledLikelihoodOf, ManyFeaturesThatSpanOrdersOfMagnitudeSeesTheirLogarithms) {
  config_.tails = Tails::compressed;
  const SimulatorFunction wide = [](const Vector& theta, Stream& stream) -> VectorF {
    return (3.0F * simulator(kMany, kMany)(theta, stream).array()).exp();
  };
  EXPECT_EQ(likelihood(wide, kMany).transform.center.size(), kMany) << "of components, too";
  const PooledLikelihood few = likelihood(
      [](const Vector& theta, Stream& stream) -> VectorF {
        return (3.0F * simulator(4, 4)(theta, stream).array()).exp();
      },
      4);
  EXPECT_EQ(few.transform.num_outputs(), 4) << "once each, though the posterior sees them twice";
}

TEST_F(PooledLikelihoodOf, ManyFeaturesThatTellOrDontSeesComponentsByAffineFlows) {
  for (const Index telling : {kMany, Index{0}}) {
    const PooledLikelihood components = likelihood(kMany, telling);
    EXPECT_EQ(components.transform.num_outputs(), kPooledComponents);
    EXPECT_EQ(components.estimator.kind, EstimatorKind::maf);
  }
  config_.estimator.kind = EstimatorKind::mdn;
  EXPECT_EQ(likelihood(kMany, kMany).estimator.kind, EstimatorKind::mdn);
}

TEST_F(PooledLikelihoodOf, ComponentsOfThePosteriorSeesThem) {
  config_.principal_components = 3;
  const PooledLikelihood components = likelihood(kMany, kMany);
  EXPECT_EQ(components.transform.num_outputs(), 3);
  EXPECT_EQ(components.estimator.kind, EstimatorKind::maf);
}

TEST_F(PooledLikelihoodOf, TrainedLayersSeesComponents) {
  config_.embedding.features = 2;
  EXPECT_EQ(likelihood(kMany, 1).transform.num_outputs(), kPooledComponents);
  EXPECT_EQ(likelihood(10, 1).transform.num_outputs(), 10);
  EXPECT_EQ(likelihood(10, 1).estimator.kind, EstimatorKind::maf);
}

}  // namespace
}  // namespace npdr::inference
