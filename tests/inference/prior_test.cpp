#include "inference/prior.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/normal.h"

namespace npdr::inference {
namespace {

Prior all_kinds() {
  return Prior({{"length", "m", Marginal::Kind::uniform, 0.3, 1.7},
                {"friction", "1", Marginal::Kind::log_uniform, 1e-4, 1e-1},
                {"offset", "rad", Marginal::Kind::normal, 0.5, 0.2},
                {"rate", "1/s", Marginal::Kind::log_normal, -0.125, 2.0}});
}

TEST(Prior, SpansAllMagnitudesOfDouble) {
  const Prior prior({{"scale", "1", Marginal::Kind::log_uniform, 1e-300, 1e300}});
  const RowMatrix u{{-1.0}, {0.0}, {2.0}};
  const RowMatrix theta = prior.to_theta(u);
  EXPECT_NEAR(std::log10(theta(1, 0)), 0.0, 1e-9);
  EXPECT_NEAR(std::log10(theta(2, 0)), 600.0 * (normal_cdf(2.0) - 0.5), 1e-9);
  EXPECT_TRUE(prior.to_normal(theta).isApprox(u, 1e-12));
  EXPECT_NEAR(prior.log_prob(theta)(2), -std::log(theta(2, 0)) - std::log(600.0 * std::log(10.0)),
              1e-9);
}

TEST(Prior, MustNotOverflow) {
  using enum Marginal::Kind;
  for (const Marginal& m :
       {Marginal{"a", "1", uniform, -1e308, 1e308}, Marginal{"a", "1", log_uniform, 1e-300, 1e308},
        Marginal{"a", "1", normal, 0.0, 1e308}}) {
    EXPECT_TRUE(m.overflows());
    EXPECT_THROW(Prior({m}), InputError);
  }
}

TEST(Prior, SamplesStayInsideOfTheSupport) {
  const Prior prior = all_kinds();
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Stream stream({1, "prior", 1, i, 0});
    EXPECT_TRUE(prior.contains(prior.sample(stream)));
  }
}

TEST(Prior, MapsToTheNormalSpaceAndBack) {
  const Prior prior = all_kinds();
  RowMatrix theta(2, 4);
  theta << 0.31, 2e-4, -0.3, 0.1, 1.69, 0.09, 1.4, 7.0;
  const RowMatrix back = prior.to_theta(prior.to_normal(theta));
  EXPECT_TRUE(back.isApprox(theta, 1e-12)) << back;
}

TEST(Prior, StaysInsideOfTheSupportHoweverFarUGoes) {
  const Prior prior = all_kinds();
  RowMatrix u(2, 4);
  u << 40.0, 40.0, 0.0, 4000.0, -40.0, -40.0, 0.0, -4000.0;
  const RowMatrix theta = prior.to_theta(u);
  EXPECT_TRUE(prior.contains(theta.row(0).transpose()));
  EXPECT_TRUE(prior.contains(theta.row(1).transpose()));
  EXPECT_TRUE(prior.to_normal(theta).allFinite());
  EXPECT_TRUE(prior.log_prob(theta).allFinite());
}

// A network that overflows has no sample to give, rather than one on the border.
TEST(Prior, HasNoParametersWhereUIsntFinite) {
  RowMatrix u(2, 4);
  u.row(0).setConstant(kInfinity);
  u.row(1).setConstant(-kInfinity);
  EXPECT_TRUE(all_kinds().to_theta(u).array().isNaN().all());
}

// Probability mass is kept: p(theta) = N(u) |du/dtheta| at any theta, by central differences.
TEST(Prior, LogDeterminantIsThatOfTheMap) {
  const Prior prior = all_kinds();
  RowMatrix theta(1, 4);
  theta << 0.9, 3e-3, 0.45, 1.2;
  double expected = 0.0;
  for (Index d = 0; d < 4; ++d) {
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
  const Prior log_normal({{"a", "1", Marginal::Kind::log_normal, -1.0, 0.4}});
  for (const Prior* prior : {&uniform, &log_uniform, &normal, &log_normal}) {
    constexpr Index n = 400'000;
    RowMatrix theta(n, 1);
    for (Index i = 0; i < n; ++i) theta(i, 0) = -1.0 + 4.0 * (static_cast<double>(i) + 0.5) / n;
    EXPECT_NEAR(prior->log_prob(theta).array().exp().sum() * 4.0 / n, 1.0, 1e-4);
  }
}

// Of kinds whose u isn't a linear function: two of each, of which one is cut off at one or both
// ends.
std::vector<Marginal> curved_kinds() {
  using enum Marginal::Kind;
  std::vector<Marginal> all = {
      {"waiting", "s", gamma, 2.5, 0.4},   {"rate", "1/s", gamma, 0.6, 2.0},
      {"share", "1", beta, 2.0, 3.0},      {"loss", "1", beta, 0.7, 1.5},
      {"spread", "m", normal, 0.0, 0.7},   {"length", "m", normal, -2.0, 1.0},
      {"drag", "1", log_normal, -0.5, 0.8}};
  all[1].to = 1.5;
  all[3].from = 0.2;
  all[4].from = 0.0;
  all[5].from = 0.1;
  all[5].to = 0.9;
  all[6].from = 0.3;
  return all;
}

// By midpoints of the density over the middle of u, where it is smooth.
TEST(Prior, CurvedKindsKeepTheirMass) {
  for (const Marginal& m : curved_kinds()) {
    const Prior prior({m});
    const auto [low, high] = m.central_range(1.0);
    constexpr Index n = 20'000;
    const double width = (high - low) / n;
    const RowMatrix theta = (Vector::LinSpaced(n, 0.5, n - 0.5) * width).array() + low;
    EXPECT_NEAR(prior.log_prob(theta).array().exp().sum() * width,
                normal_cdf(1.0) - normal_cdf(-1.0), 1e-7)
        << m.name;
    const double middle = theta(n / 3, 0), step = 1e-6 * middle;
    const RowMatrix u = prior.to_normal(RowMatrix{{middle - step}, {middle}, {middle + step}});
    EXPECT_NEAR(prior.log_det_to_normal(RowMatrix{{middle}})(0),
                std::log((u(2, 0) - u(0, 0)) / (2.0 * step)), 1e-7)
        << m.name;
    const RowMatrix far{{-40.0}, {-6.0}, {-2.0}, {0.3}, {6.0}, {40.0}};
    const RowMatrix there = prior.to_theta(far);
    EXPECT_NEAR(prior.to_normal(there)(1, 0), -6.0, 1e-3) << m.name;
    EXPECT_LT((prior.to_normal(there) - far).middleRows(2, 2).cwiseAbs().maxCoeff(), 1e-10)
        << m.name;
    EXPECT_TRUE(prior.log_prob(there.middleRows(1, 4)).allFinite()) << m.name;
    EXPECT_GE(there(0, 0), m.lower());
    EXPECT_LE(there(5, 0), m.upper());
  }
}

TEST(Prior, CurvedKindsWithClosedForms) {
  using enum Marginal::Kind;
  Marginal half{"half", "1", normal, 0.0, 2.0};
  half.from = 0.0;
  const Prior prior({{"exponential", "1", gamma, 1.0, 3.0}, {"power", "1", beta, 1.0, 4.0}, half});
  const double p = normal_cdf(0.8);
  const RowMatrix theta = prior.to_theta(RowMatrix::Constant(1, 3, 0.8));
  EXPECT_NEAR(theta(0, 0), -3.0 * std::log1p(-p), 1e-12);
  EXPECT_NEAR(theta(0, 1), 1.0 - std::pow(1.0 - p, 0.25), 1e-12);
  EXPECT_NEAR(theta(0, 2), 2.0 * normal_quantile(0.5 + 0.5 * p), 1e-12);
}

TEST(Prior, DensityIsZeroOutsideOfTheSupport) {
  RowMatrix theta(4, 4);
  theta << 1.71, 1e-3, 0.5, 1.0, 1.0, 1e-3, 0.5, 0.0, 1.0, 1e-3, 0.5, -1.0, 1.0, 1e-3, 0.5, kNaN;
  for (Index row = 0; row < 3; ++row) {
    EXPECT_EQ(all_kinds().log_prob(theta)(row), -kInfinity);
    EXPECT_FALSE(all_kinds().contains(theta.row(row).transpose()));
  }
  EXPECT_FALSE(all_kinds().contains(theta.row(3).transpose()));
  EXPECT_NEAR(all_kinds().to_normal(theta)(2, 3), -8.2, 0.1) << "the nearest finite value";
}

TEST(Prior, CentralRangeIsTheBoundsOrFollowsTheNormalSpace) {
  const Prior prior = all_kinds();
  const std::vector<Marginal>& marginals = prior.marginals();
  EXPECT_EQ(marginals[0].central_range(3.0), std::pair(0.3, 1.7));
  EXPECT_EQ(marginals[1].central_range(3.0), std::pair(1e-4, 1e-1));
  EXPECT_EQ(marginals[2].central_range(2.0), std::pair(0.5 - 0.2 * 2.0, 0.5 + 0.2 * 2.0));
  EXPECT_DOUBLE_EQ(marginals[3].central_range(1.0).first, std::exp(-2.125));
  EXPECT_DOUBLE_EQ(marginals[3].central_range(1.0).second, std::exp(1.875));
}

TEST(Prior, RejectsImpossibleMarginals) {
  EXPECT_THROW(Prior({}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::uniform, 1.0, 1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::log_uniform, 0.0, 1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::normal, 0.0, -1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::log_normal, 0.0, 0.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::log_normal, 800.0, 1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::log_normal, 0.0, 100.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::uniform, 0.0, kNaN}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::gamma, 0.0, 1.0}}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::beta, 1.0, -1.0}}), InputError);
  Marginal cut{"a", "1", Marginal::Kind::normal, 0.0, 1.0};
  cut.from = 7.0;
  EXPECT_THROW(Prior({cut}), InputError);
  EXPECT_THROW(Prior({{"a", "1", Marginal::Kind::uniform, 0.0, 1.0},
                      {"a", "1", Marginal::Kind::uniform, 0.0, 1.0}}),
               InputError);
}

}  // namespace
}  // namespace npdr::inference
