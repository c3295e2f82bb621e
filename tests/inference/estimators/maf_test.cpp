#include "inference/estimators/maf.h"

#include <gtest/gtest.h>

#include <utility>

#include "core/error.h"
#include "core/normal.h"
#include "inference/estimators/affine_map.h"
#include "inference/estimators/spline_map.h"
#include "tests/inference/estimators/estimator_checks.h"

namespace npdr::inference {
namespace {

const StreamId kStructure{1, "structure", 0, 0, 0};

// Both kinds: with affine transforms and with splines.
class Flow : public ::testing::TestWithParam<EstimatorKind> {
 protected:
  static EstimatorConfig small_config(Index hidden_layers = 2) {
    EstimatorConfig config;
    config.kind = GetParam();
    config.num_bins = 4;
    config.num_transforms = 3;
    config.hidden_features = 7;
    config.num_hidden_layers = hidden_layers;
    return config;
  }
};
INSTANTIATE_TEST_SUITE_P(Kinds, Flow, ::testing::Values(EstimatorKind::maf, EstimatorKind::nsf));

TEST_P(Flow, BackwardPassEqualsCentralDifferences) {
  for (const Index layers : {1, 2, 3}) {
    ParameterLayout layout;
    const MaskedAutoregressiveFlow<double> maf(small_config(layers), 4, 5, kStructure, layout);
    expect_gradients_of(maf, layout.size(), 3, 4);
  }
}

TEST_P(Flow, BackwardPassHoldsForOneVariableAndForMoreVariablesThanHiddenUnits) {
  for (const Index dimension : {1, 9}) {
    ParameterLayout layout;
    const MaskedAutoregressiveFlow<double> maf(small_config(), dimension, 2, kStructure, layout);
    expect_gradients_of(maf, layout.size(), 4, 1);
  }
}

TEST_P(Flow, BackwardPassHoldsWhereLayersAreWideEnoughForSeveralBlocks) {
  EstimatorConfig config = small_config();
  config.num_transforms = 1;
  config.hidden_features = 60;  // three blocks of two degrees
  for (const Index layers : {2, 3}) {
    config.num_hidden_layers = layers;
    ParameterLayout layout;
    const MaskedAutoregressiveFlow<double> maf(config, 6, 2, kStructure, layout);
    for (const Index k : {1, 2}) expect_gradients_of(maf, layout.size(), 3, k);
  }
}

TEST_P(Flow, DensityIntegratesToOne) {
  ParameterLayout layout;
  const MaskedAutoregressiveFlow<double> maf(small_config(), 2, 3, kStructure, layout);
  // The integrand is smooth on the scale of the grid, but for the splines' knots: the midpoint rule
  // is exact to 1e-6.
  EXPECT_NEAR(mass_on_a_grid(maf, random_parameters(maf, layout.size(), 2)), 1.0, 1e-5);
}

TEST_P(Flow, StartsNearThePrior) {
  ParameterLayout layout;
  EstimatorConfig config;
  config.kind = GetParam();
  const MaskedAutoregressiveFlow<double> maf(config, 9, 20, kStructure, layout);
  Vector parameters = Vector::Zero(layout.size());
  Stream stream({1, "initial", 0, 0, 0});
  maf.initialize(parameters, stream);
  const RowMatrix u = random_matrix(50, 9, 1);
  const auto scratch = maf.make_scratch();
  Vector log_prob;
  maf.log_prob(parameters, u, random_matrix(50, 20, 2), *scratch, log_prob);
  Vector expected = Vector::Zero(50);
  for (Index i = 0; i < 50; ++i) {
    for (Index d = 0; d < 9; ++d) expected(i) += log_normal_density(u(i, d));
  }
  EXPECT_LT((log_prob - expected).cwiseAbs().mean(), 0.5);
}

TEST_P(Flow, InverseOfATransformUndoesForward) {
  // The last has layers of several blocks.
  for (const auto& [dimension, hidden] : {std::pair<Index, Index>{1, 7}, {3, 7}, {9, 7}, {6, 60}}) {
    ParameterLayout layout;
    std::shared_ptr<const ElementMap<double>> map = std::make_shared<AffineMap<double>>();
    if (GetParam() == EstimatorKind::nsf) map = std::make_shared<SplineMap<double>>(5);
    const AutoregressiveTransform<double> transform(dimension, hidden, 2, map, layout);
    Vector parameters = Vector::Zero(layout.size());
    Stream stream({1, "initial", 0, 0, 0});
    transform.initialize(parameters, stream);
    parameters *= 5.0;
    const RowMatrix context = random_matrix(1, hidden, 6);
    AutoregressiveScratch<double> scratch;
    scratch.input = random_matrix(20, dimension, 2);
    ColumnMatrixX<double> z;
    Vector log_det = Vector::Zero(20);
    transform.forward(parameters, context, scratch, z, log_det);
    EXPECT_FALSE(z.isApprox(scratch.input, 1e-2));
    EXPECT_TRUE(transform.inverse(parameters, context, z).isApprox(scratch.input, 1e-10));
  }
}

// If samples follow q, then the mean of log q(sample) is minus the entropy; with an importance
// weight to another density of known mass the samples and the density check each other:
// E_q[ N(u; 0, 0.5 I) / q(u) ] = 1 where q has mass wherever N does.
TEST_P(Flow, SamplesFollowTheDensity) {
  ParameterLayout layout;
  const MaskedAutoregressiveFlow<double> maf(small_config(), 2, 3, kStructure, layout);
  const Vector parameters = random_parameters(maf, layout.size(), 5);
  const RowMatrix context = random_matrix(1, 3, 6);
  constexpr Index n = 20'000;
  const RowMatrix u = maf.sample(parameters, context, n, {4, "sample", 0, 0, 0});
  const auto scratch = maf.make_scratch();
  Vector log_prob;
  maf.log_prob(parameters, u, context, *scratch, log_prob);
  const Vector mean = u.colwise().mean().transpose();
  Vector ratio(n);
  for (Index i = 0; i < n; ++i) {
    double log_target = 0.0;
    for (Index d = 0; d < 2; ++d) {
      log_target += log_normal_density((u(i, d) - mean(d)) / 0.5) - std::log(0.5);
    }
    ratio(i) = std::exp(log_target - log_prob(i));
  }
  const double average = ratio.mean();
  const double standard_error =
      std::sqrt((ratio.array() - average).square().mean() / static_cast<double>(n));
  ASSERT_LT(standard_error, 0.02);
  EXPECT_NEAR(average, 1.0, 4.0 * standard_error);  // false-alarm rate 6e-5, fixed seed
}

TEST_P(Flow, RejectsSizesBelowOne) {
  ParameterLayout layout;
  EstimatorConfig config;
  config.kind = GetParam();
  config.num_transforms = 0;
  EXPECT_THROW(MaskedAutoregressiveFlow<float>(config, 2, 2, kStructure, layout), InputError);
}

}  // namespace
}  // namespace npdr::inference
