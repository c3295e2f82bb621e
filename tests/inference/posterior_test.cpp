#include "inference/direct_posterior.h"

#include <gtest/gtest.h>
#include <omp.h>

#include "core/error.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

DirectPosterior untrained(EstimatorKind kind) {
  NetworkParts parts{.prior = Prior({{"a", "1", Marginal::Kind::uniform, -1.0, 3.0},
                                     {"b", "1", Marginal::Kind::uniform, 0.0, 0.5}}),
                     .estimator = {},
                     .embedding = {3},
                     .structure_seed = 5,
                     .transform = {VectorF::Zero(4), VectorF::Ones(4), {}},
                     .parameters = {},
                     .x_o = VectorF::Constant(4, 0.3f)};
  parts.estimator.kind = kind;
  parts.estimator.num_transforms = 2;
  parts.estimator.num_components = 3;
  const auto network = make_network(parts.estimator, 4, {3}, 2, 5);
  parts.parameters = network.initial_parameters({1, "initial", 0, 0, 0});
  return DirectPosterior(parts);
}

TEST(DirectPosterior, DensityOverThePriorsBoxIntegratesToOne) {
  for (const EstimatorKind kind : {EstimatorKind::maf, EstimatorKind::mdn}) {
    const DirectPosterior posterior = untrained(kind);
    constexpr Index side = 300;
    RowMatrix theta(side * side, 2);
    for (Index i = 0; i < side; ++i) {
      for (Index j = 0; j < side; ++j) {
        theta(i * side + j, 0) = -1.0 + 4.0 * (static_cast<double>(i) + 0.5) / side;
        theta(i * side + j, 1) = 0.5 * (static_cast<double>(j) + 0.5) / side;
      }
    }
    // Densities may rise toward the border of the box: the midpoint rule is good to a percent.
    EXPECT_NEAR(posterior.log_prob(theta).array().exp().sum() * 2.0 / (side * side), 1.0, 0.01)
        << name_of(kind);
  }
}

TEST(DirectPosterior, SamplesLieInThePriorsSupport) {
  for (const EstimatorKind kind : {EstimatorKind::maf, EstimatorKind::mdn}) {
    const DirectPosterior posterior = untrained(kind);
    const RowMatrix theta = posterior.sample(1000, {1, "posterior", 0, 0, 0});
    for (Index i = 0; i < theta.rows(); ++i) {
      EXPECT_TRUE(posterior.prior().contains(theta.row(i).transpose()));
    }
  }
}

TEST(DirectPosterior, SamplesHaveTheSameBitsForAnyCountAndThreadCount) {
  for (const EstimatorKind kind : {EstimatorKind::maf, EstimatorKind::mdn}) {
    const DirectPosterior posterior = untrained(kind);
    const StreamId id{1, "posterior", 0, 0, 0};
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    const RowMatrix many = posterior.sample(300, id);
    const Vector log_prob = posterior.log_prob(many);
    omp_set_num_threads(3);
    EXPECT_EQ(posterior.sample(300, id), many);
    EXPECT_EQ(posterior.sample(17, id), many.topRows(17));
    EXPECT_EQ(posterior.log_prob(many.topRows(17)), log_prob.head(17));
    omp_set_num_threads(threads);
  }
}

TEST(DirectPosterior, MapIsAtLeastAsLikelyAsAnySample) {
  for (const EstimatorKind kind : {EstimatorKind::maf, EstimatorKind::mdn}) {
    const DirectPosterior posterior = untrained(kind);
    const StreamId id{1, "map", 0, 0, 0};
    const Vector map = posterior.map(id);
    EXPECT_TRUE(posterior.prior().contains(map));
    EXPECT_GE(posterior.log_prob(map.transpose())(0),
              posterior.log_prob(posterior.sample(1000, id)).maxCoeff() - 1e-6);
  }
}

TEST(DirectPosterior, RejectsPartsThatDontGoTogether) {
  NetworkParts parts = untrained(EstimatorKind::maf).parts();
  parts.parameters.conservativeResize(parts.parameters.size() - 1);
  EXPECT_THROW(DirectPosterior{parts}, ShapeError);
}

TEST(DirectPosterior, OnlyAMixtureHasAMixture) {
  EXPECT_THROW(untrained(EstimatorKind::maf).mixture(), Error);
  EXPECT_EQ(untrained(EstimatorKind::mdn).mixture().num_components(), 3);
}

}  // namespace
}  // namespace npdr::inference
