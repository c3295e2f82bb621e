#include "inference/dequantized_features.h"

#include <gtest/gtest.h>

#include "inference/matrix_features.h"
#include "tests/inference/gradient_check.h"
#include "tests/inference/linear_gaussian_check.h"

namespace npdr::inference {
namespace {

RowMatrixF of_epoch(const FeatureSource& x, const std::vector<std::uint32_t>& rows,
                    std::uint64_t epoch) {
  RowMatrixF found;
  x.gather(rows, epoch, found);
  return found;
}

TEST(DequantizedFeatures, NoiseIsThatOfCountsAlone) {
  RowMatrixF x = random_matrix(100, 3, 1).cast<float>();
  x.col(1) = (10.0f * x.col(1).array()).round();
  const MatrixFeatures source(x);
  EXPECT_EQ(integer_features(source), (std::vector<Index>{1}));
  const DequantizedFeatures noisy(source, 1);
  const RowMatrixF first = of_epoch(noisy, {0, 1, 2, 3}, 1);
  EXPECT_EQ(first.col(0), x.col(0).head(4));
  EXPECT_EQ(first.col(2), x.col(2).head(4));
  EXPECT_EQ(first.col(1).array().round().matrix(), x.col(1).head(4));
  EXPECT_GT((first.col(1) - x.col(1).head(4)).norm(), 0.0f);
  EXPECT_EQ(of_epoch(noisy, {3}, 1), first.bottomRows(1)) << "whatever the batch";
  EXPECT_NE(of_epoch(noisy, {3}, 2), first.bottomRows(1)) << "drawn anew";
}

// x ~ Poisson(exp(a)), a ~ U(0, 2): the posterior given a count on a grid.
TEST(DequantizedFeatures, TheLikelihoodOfACountIsItsProbability) {
  const SimulatorFunction poisson = [](const Vector& theta, Stream& stream) -> VectorF {
    int count = -1;
    for (double sum = 0.0; sum < std::exp(theta(0)); ++count) sum -= std::log(stream.uniform());
    return VectorF::Constant(1, static_cast<float>(count));
  };
  const Prior prior({{"a", "1", Marginal::Kind::uniform, 0.0, 2.0}});
  PosteriorEstimationConfig config = small_config(Algorithm::nle, EstimatorKind::nsf, 1, 2000);
  config.tails = Tails::compressed;
  constexpr float count = 2.0f;
  const auto posterior = infer(config, prior, poisson, VectorF::Constant(1, count), 1);
  const Vector a = Vector::LinSpaced(201, 0.0, 2.0);
  Vector exact = (count * a.array() - a.array().exp()).exp();
  Vector found = posterior->log_prob(a).array().exp();
  exact /= exact.sum();
  found /= found.sum();
  EXPECT_NEAR(found.dot(a), exact.dot(a), 0.1);
  // Total variation; with spikes in place of a density it is 0.2 and more.
  EXPECT_LT(0.5 * (found - exact).lpNorm<1>(), 0.1);
}

}  // namespace
}  // namespace npdr::inference
