#include "inference/direct_posterior.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/inference/cells.h"
#include "tests/inference/gradient_check.h"
#include "tests/thread_count.h"

namespace npdr::inference {
namespace {

DirectPosterior untrained(EstimatorKind kind) {
  NetworkParts parts{.prior = Prior({{"a", "1", Marginal::Kind::uniform, -1.0, 3.0},
                                     {"b", "1", Marginal::Kind::uniform, 0.0, 0.5}}),
                     .of_role = DirectParts{.embedding = {3}},
                     .estimator = {},
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

// Of each kind.
class DirectPosteriors : public ::testing::TestWithParam<EstimatorKind> {
 protected:
  const DirectPosterior posterior_ = untrained(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Kinds, DirectPosteriors,
                         ::testing::ValuesIn(kinds_that_give(Estimate::density)));

TEST_P(DirectPosteriors, DensityOverThePriorsBoxIntegratesToOne) {
  constexpr Index side = 300;
  const RowMatrix theta = cells_of({-1.0, 0.0}, {3.0, 0.5}, side);
  // Densities may rise toward the border of the box: the midpoint rule is good to a percent.
  EXPECT_NEAR(posterior_.log_prob(theta).array().exp().sum() * 2.0 / (side * side), 1.0, 0.01);
}

TEST_P(DirectPosteriors, SamplesLieInThePriorsSupport) {
  const RowMatrix theta = posterior_.sample(1000, {1, "posterior", 0, 0, 0});
  for (Index i = 0; i < theta.rows(); ++i) {
    EXPECT_TRUE(posterior_.prior().contains(theta.row(i).transpose()));
  }
}

TEST_P(DirectPosteriors, SamplesHaveTheSameBitsForAnyCountAndThreadCount) {
  const StreamId id{1, "posterior", 0, 0, 0};
  const RowMatrix many = posterior_.sample(300, id);
  for (const Index count : {300, 17}) {
    expect_same_for_any_thread_count([&] {
      const RowMatrix some = posterior_.sample(count, id);
      EXPECT_EQ(some, many.topRows(count));
      return posterior_.log_prob(some);
    });
  }
  EXPECT_EQ(posterior_.log_prob(many.topRows(17)), posterior_.log_prob(many).head(17));
}

TEST_P(DirectPosteriors, MapIsAtLeastAsLikelyAsAnySample) {
  const StreamId id{1, "map", 0, 0, 0};
  const Vector map = posterior_.map(id);
  EXPECT_TRUE(posterior_.prior().contains(map));
  EXPECT_GE(posterior_.log_prob(map.transpose())(0),
            posterior_.log_prob(posterior_.sample(1000, id)).maxCoeff() - 1e-6);
}

// A posterior whose density is a number at some of its samples only, or at none.
class NumberlessPosterior : public Posterior {
 public:
  explicit NumberlessPosterior(bool has_numbers) : has_numbers_(has_numbers) {}
  const Prior& prior() const override { return prior_; }
  Samples draw(Index n, const StreamId&) const override { return {Vector::LinSpaced(n, 0.1, 0.9)}; }
  Vector log_prob(const RowMatrix& theta) const override {
    const auto peak = -(theta.col(0).array() - 0.6).square();
    return (theta.col(0).array() > (has_numbers_ ? 0.3 : 2.0)).select(peak, kNaN);
  }

 private:
  Prior prior_{{{"a", "1", Marginal::Kind::uniform, 0.0, 1.0}}};
  bool has_numbers_;
};

TEST(Posterior, MapLeavesOutWhatIsNoNumber) {
  EXPECT_NEAR(NumberlessPosterior(true).map({1, "map", 0, 0, 0})(0), 0.6, 1e-3);
  EXPECT_THROW(NumberlessPosterior(false).map({1, "map", 0, 0, 0}), Error);
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
