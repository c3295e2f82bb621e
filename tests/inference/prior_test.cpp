#include "inference/prior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/normal.h"

namespace npdr::inference {
namespace {

Prior three_kinds() {
  return Prior({{"length", "m", Marginal::Kind::uniform, 0.3, 1.7},
                {"friction", "1", Marginal::Kind::log_uniform, 1e-4, 1e-1},
                {"offset", "rad", Marginal::Kind::normal, 0.5, 0.2}});
}

TEST(Prior, SamplesStayInsideOfTheSupport) {
  const Prior prior = three_kinds();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Stream stream({1, "prior", 1, i, 0});
    EXPECT_TRUE(prior.contains(prior.sample(stream)));
  }
}

TEST(Prior, MapsToTheNormalSpaceAndBack) {
  const Prior prior = three_kinds();
  RowMatrix theta(2, 3);
  theta << 0.31, 2e-4, -0.3, 1.69, 0.09, 1.4;
  const RowMatrix back = prior.to_theta(prior.to_normal(theta));
  EXPECT_TRUE(back.isApprox(theta, 1e-12)) << back;
}

TEST(Prior, StaysInsideOfTheSupportHoweverFarUGoes) {
  const Prior prior = three_kinds();
  RowMatrix u(2, 3);
  u << 40.0, 40.0, 0.0, -40.0, -40.0, 0.0;
  const RowMatrix theta = prior.to_theta(u);
  EXPECT_TRUE(prior.contains(theta.row(0).transpose()));
  EXPECT_TRUE(prior.contains(theta.row(1).transpose()));
  EXPECT_TRUE(prior.to_normal(theta).allFinite());
}

// Probability mass is kept: p(theta) = N(u) |du/dtheta| at any theta, by central differences.
TEST(Prior, LogDeterminantIsThatOfTheMap) {
  const Prior prior = three_kinds();
  RowMatrix theta(1, 3);
  theta << 0.9, 3e-3, 0.45;
  double expected = 0.0;
  for (Index d = 0; d < 3; ++d) {
    const double h = 1e-6 * theta(0, d);
    RowMatrix above = theta, below = theta;
    above(0, d) += h;
    below(0, d) -= h;
    expected += std::log((prior.to_normal(above)(0, d) - prior.to_normal(below)(0, d)) / (2.0 * h));
  }
  EXPECT_NEAR(prior.log_det_to_normal(theta)(0), expected, 1e-7);
}

TEST(Prior, LogDensityOfEachKindIntegratesToOne) {
  const Prior uniform({{"a", "1", Marginal::Kind::uniform, -1.0, 3.0}});
  const Prior log_uniform({{"a", "1", Marginal::Kind::log_uniform, 0.01, 2.0}});
  const Prior normal({{"a", "1", Marginal::Kind::normal, 1.0, 0.3}});
  for (const Prior* prior : {&uniform, &log_uniform, &normal}) {
    constexpr Index n = 400'000;
    RowMatrix theta(n, 1);
    for (Index i = 0; i < n; ++i) theta(i, 0) = -1.0 + 4.0 * (static_cast<double>(i) + 0.5) / n;
    EXPECT_NEAR(prior->log_prob(theta).array().exp().sum() * 4.0 / n, 1.0, 1e-4);
  }
}

TEST(Prior, DensityIsZeroOutsideOfTheSupport) {
  RowMatrix theta(1, 3);
  theta << 1.71, 1e-3, 0.5;
  EXPECT_EQ(three_kinds().log_prob(theta)(0), -std::numeric_limits<double>::infinity());
  EXPECT_FALSE(three_kinds().contains(theta.row(0).transpose()));
}

TEST(Prior, RejectsImpossibleMarginals) {
  EXPECT_THROW(Prior({}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::uniform, 1.0, 1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::log_uniform, 0.0, 1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::normal, 0.0, -1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::uniform, 0.0, std::nan("")}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::uniform, 0.0, 1.0},
                      {"a", "1", Marginal::Kind::uniform, 0.0, 1.0}}),
               InputError);
}

}  // namespace
}  // namespace npdr::inference
