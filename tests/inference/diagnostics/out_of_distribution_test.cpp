#include "inference/diagnostics/out_of_distribution.h"

#include <gtest/gtest.h>

#include "core/constants.h"
#include "core/error.h"
#include "tests/inference/diagnostics/samples.h"

namespace npdr::inference {
namespace {

// 30 features of two parameters, with noise of 0.05: simulations fill a plane but for the noise.
constexpr Index kFeatures = 30;

RowMatrixF features(const RowMatrix& theta, std::uint64_t seed) {
  const RowMatrix map = gaussian(2, kFeatures, 99);
  return (theta * map + gaussian(theta.rows(), kFeatures, seed, 0.0, 0.05)).cast<float>();
}

VectorF observation(double first, double second) {
  RowMatrix theta(1, 2);
  theta << first, second;
  return features(theta, 7).row(0).transpose();
}

OutOfDistribution tested(const RowMatrixF& x, const VectorF& x_o) {
  return test_out_of_distribution(usual_features(x), x_o);
}

// At most 8 of 100 simulations among others have p < 0.02: P(more) = 1e-3 by chance for 2 expected,
// fixed seed; p is three times the smallest of three, so fewer are likely.
TEST(OutOfDistribution, ASimulationLooksLikeTheOthers) {
  int alarms = 0;
  for (std::uint64_t trial = 1; trial <= 100; ++trial) {
    const RowMatrixF x = features(gaussian(401, 2, 2 * trial), 2 * trial + 1);
    alarms += tested(x.topRows(400), x.row(400).transpose()).p_value < 0.02 ? 1 : 0;
  }
  EXPECT_LE(alarms, 8);
}

TEST(OutOfDistribution, FindsWhatIsFarOutInAKnownDirection) {
  const RowMatrixF x = features(gaussian(1000, 2, 1), 2);
  const OutOfDistribution found = tested(x, observation(8.0, 0.0));
  EXPECT_LT(found.mahalanobis.p_value, 1e-4);
  EXPECT_GT(found.mahalanobis.observed, 4.0 * found.mahalanobis.median);
  EXPECT_LT(found.p_value, 1e-3);
}

TEST(OutOfDistribution, FindsADirectionThatNoSimulationHas) {
  const RowMatrixF x = features(gaussian(1000, 2, 1), 2);
  VectorF off = observation(0.0, 0.0);
  off += gaussian(1, kFeatures, 5, 0.0, 0.5).row(0).transpose().cast<float>();
  const OutOfDistribution found = tested(x, off);
  EXPECT_LT(found.residual.p_value, 1e-4);
  EXPECT_LT(found.p_value, 1e-3);
}

// Rates exp(a + b t) over six decades: over their deviation all but the largest are nearly equal.
TEST(OutOfDistribution, FindsWhatNoCountsDoAmongSmallOnes) {
  const RowMatrix theta = gaussian(1000, 2, 1);
  RowMatrixF x(1000, 8);
  for (Index f = 0; f < 8; ++f) {
    x.col(f) =
        (4.0 + 2.0 * theta.col(0).array() + 0.5 * static_cast<double>(f) * theta.col(1).array())
            .exp()
            .round()
            .cast<float>();
  }
  VectorF zigzag(8);
  zigzag << 5, 300, 5, 300, 5, 300, 5, 300;
  EXPECT_GT(tested(x, zigzag).p_value, 0.1);
  const UsualFeatures usual = usual_features(x, Tails::compressed);
  EXPECT_LT(test_out_of_distribution(usual, zigzag).p_value, 1e-3);
  EXPECT_GT(test_out_of_distribution(usual, x.row(999).transpose()).p_value, 0.01);
}

// Log-normal, the least of 400 some 1e-4: a logarithm of a kind is linear there.
TEST(OutOfDistribution, FindsWhatIsNearerToZeroThanAnySimulation) {
  RowMatrixF x = (3.0 * gaussian(400, 1, 1)).array().exp().matrix().cast<float>();
  for (const float sign : {1.0f, -1.0f}) {
    x *= sign;
    const UsualFeatures usual = usual_features(x, Tails::compressed);
    const float nearest = sign * x.cwiseAbs().minCoeff();
    const auto p_value = [&](float value) {
      return test_out_of_distribution(usual, VectorF::Constant(1, value)).p_value;
    };
    EXPECT_GT(p_value(0.5f * nearest), 0.01);
    EXPECT_LT(p_value(0.005f * nearest), 1e-3);
    EXPECT_LT(p_value(0.0f), 1e-3);
    EXPECT_LT(p_value(-nearest), 1e-3);
    EXPECT_EQ(impossible_feature(usual, VectorF::Constant(1, 0.0f)), Index{0});
  }
  // Counts of which none happens to be 0.
  const RowMatrixF counts = x.cwiseAbs().array().ceil();
  const UsualFeatures usual = usual_features(counts, Tails::compressed);
  EXPECT_EQ(impossible_feature(usual, VectorF::Zero(1)), std::nullopt);
  EXPECT_EQ(impossible_feature(usual, VectorF::Constant(1, -100.0f)), Index{0});
}

TEST(OutOfDistribution, FindsAFeatureThatWasTheSameInAllSimulations) {
  RowMatrixF x = features(gaussian(1000, 2, 1), 2);
  VectorF same = observation(0.0, 0.0);
  x.col(5).setConstant(3.0f);
  same(5) = 3.0f * (1.0f + 1e-6f);  // rounding
  EXPECT_GT(tested(x, same).p_value, 0.01);
  same(5) = 3.1f;
  const OutOfDistribution found = tested(x, same);
  EXPECT_LT(found.residual.p_value, 1e-4);
  EXPECT_LT(found.p_value, 1e-3);
}

// Nothing lies beyond the components of two features, so that all residuals are the same.
TEST(OutOfDistribution, FindsAConstantFeatureWhereThereIsNoResidual) {
  RowMatrixF x = gaussian(200, 2, 1).cast<float>();
  x.col(1).setConstant(3.0f);
  VectorF observed(2);
  observed << 0.0f, 3.0f;
  EXPECT_GT(tested(x, observed).p_value, 0.01);
  observed(1) = 4.0f;
  EXPECT_LT(tested(x, observed).p_value, 1e-3);
}

TEST(OutOfDistribution, FindsAnotherValueWhereAllSimulationsAreTheSame) {
  for (const Index n : {kFewestSimulations, Index{200}}) {
    const RowMatrixF x = RowMatrixF::Constant(n, 2, 3.0f);
    const OutOfDistribution same = tested(x, VectorF::Constant(2, 3.0f));
    EXPECT_GT(same.p_value, 0.01);
    EXPECT_EQ(same.residual.median, 0.0);
    EXPECT_LT(tested(x, VectorF::Constant(2, 4.0f)).p_value, 1e-3) << n;
  }
}

TEST(OutOfDistribution, AFarObservationMakesNoFeatureConstant) {
  const RowMatrixF x = gaussian(200, 2, 1).cast<float>();
  const OutOfDistribution found = tested(x, VectorF{{0.0f, 1e6f}});
  EXPECT_LT(found.p_value, 1e-3);
  EXPECT_TRUE(std::isfinite(found.residual.observed));
}

// Parameters on a ring: its center is near the mean, but no simulation is near it.
TEST(OutOfDistribution, FindsAHole) {
  RowMatrix theta = gaussian(1000, 2, 1);
  theta = theta.rowwise().normalized().eval();
  const OutOfDistribution found = tested(features(theta, 2), observation(0.0, 0.0));
  EXPECT_GT(found.mahalanobis.p_value, 0.01);
  EXPECT_LT(found.nearest.p_value, 1e-3);
}

TEST(OutOfDistribution, RejectsWhatCantBeJudged) {
  const RowMatrixF x = features(gaussian(100, 2, 1), 2);
  EXPECT_THROW(tested(x, VectorF::Zero(3)), ShapeError);
  EXPECT_THROW(tested(x.topRows(39), VectorF::Zero(kFeatures)), InputError);
  VectorF broken = VectorF::Zero(kFeatures);
  broken(4) = kFloatNaN;
  EXPECT_THROW(tested(x, broken), InputError);
}

}  // namespace
}  // namespace npdr::inference
