#include "pipeline/sources/marginal_fit.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

using Kind = inference::Marginal::Kind;

MarginalFit fit_to(const Vector& values) {
  MarginalFit fit;
  for (Index begin = 0; begin < values.size(); begin += 300) {
    fit.observe(values.segment(begin, std::min<Index>(300, values.size() - begin)));
  }
  return fit;
}

// Mean log densities of another form are 0.1 below at least, seven standard errors of 1000 draws:
// by chance it wins once in 10^12 times.
TEST(MarginalFit, FindsWhatValuesAreDrawnFrom) {
  const std::vector<inference::Marginal> marginals = {{"a", "1", Kind::uniform, 1.0, 6.0},
                                                      {"b", "1", Kind::log_uniform, 1e-3, 0.05},
                                                      {"c", "1", Kind::normal, -2.0, 3.0},
                                                      {"d", "1", Kind::log_normal, 1.0, 0.7}};
  const RowMatrix theta = inference::sample_prior(inference::Prior(marginals), 1000, 1);
  for (Index d = 0; d < 4; ++d) {
    const inference::Marginal& truth = marginals[static_cast<std::size_t>(d)];
    const inference::Marginal found = fit_to(theta.col(d)).likeliest();
    EXPECT_EQ(found.kind, truth.kind) << truth.name;
    if (truth.is_uniform()) {
      const double low = theta.col(d).minCoeff(), high = theta.col(d).maxCoeff();
      const double step = (high - low) / 999.0;
      EXPECT_LT(found.a, low);
      EXPECT_GT(found.b, high);
      EXPECT_GT(found.a, low - 0.55 * (truth.kind == Kind::uniform ? step : 0.01 * low));
      EXPECT_LT(found.b, high + 0.55 * (truth.kind == Kind::uniform ? step : 0.01 * high));
      continue;
    }
    EXPECT_NEAR(found.a, truth.a, 5.0 * truth.b / std::sqrt(1000.0));
    EXPECT_NEAR(found.b, truth.b, 5.0 * truth.b / std::sqrt(2000.0));
  }
}

TEST(MarginalFit, BoundsOfAGridAreHalfAStepBeyondIt) {
  const auto grid_of = [](double low, double high) {
    return fit_to(Vector::LinSpaced(11, low, high).replicate(500, 1)).likeliest();
  };
  EXPECT_EQ(grid_of(0.0, 1.0).a, -0.05);
  EXPECT_EQ(grid_of(0.0, 1.0).b, 1.05);
  EXPECT_EQ(grid_of(0.01, 1.01).a, 0.0);
  EXPECT_EQ(grid_of(1000.0, 3000.0).a, 900.0);
  EXPECT_EQ(grid_of(1000.0, 3000.0).b, 3100.0);
  // A decade in 10 steps: half of one is a factor of 10^0.05.
  const inference::Marginal decade =
      fit_to(Vector(Vector::LinSpaced(11, -3.0, -2.0).unaryExpr([](double v) {
               return std::pow(10.0, v);
             })).replicate(500, 1))
          .likeliest();
  EXPECT_EQ(decade.kind, Kind::log_uniform);
  EXPECT_NEAR(decade.a, 1e-3 / std::pow(10.0, 0.05), 1e-5);
  EXPECT_NEAR(decade.b, 1e-2 * std::pow(10.0, 0.05), 1e-4);
}

TEST(MarginalFit, BoundsOfAnyStepHoldTheValues) {
  const auto bounds_of = [](const Vector& values) {
    const inference::Marginal found = fit_to(values.replicate(200, 1)).likeliest();
    EXPECT_LT(found.lower(), values.minCoeff());
    EXPECT_GT(found.upper(), values.maxCoeff());
    return found;
  };
  EXPECT_EQ(bounds_of(Vector{{1.0, 1e5, 1e10}}).kind, Kind::log_uniform);
  EXPECT_GT(bounds_of(Vector{{1e-6, 1.0, 1e6}}).a, 0.0);
  EXPECT_EQ(bounds_of(Vector{{1.0, 2.0, 3.0}}).kind, Kind::uniform);
  const Vector nearly_constant = Vector::LinSpaced(50, 5.0, 5.0 + 1e-12);
  EXPECT_EQ(fit_to(nearly_constant).likeliest().kind, Kind::uniform);
}

TEST(MarginalFit, OfAGridIsWhereverItBegins) {
  const auto kind_of = [](const Vector& levels) {
    return fit_to(levels.replicate(100, 1)).likeliest().kind;
  };
  EXPECT_EQ(kind_of(Vector{{1e-6, 0.5, 1.0}}), Kind::uniform);
  EXPECT_EQ(kind_of(Vector::LinSpaced(5, 1e-6, 1.0)), Kind::uniform);
  EXPECT_EQ(kind_of(Vector{{0.1, 10.0}}), Kind::uniform);
  EXPECT_EQ(kind_of(Vector{{0.1, 0.5, 1.0, 2.0}}), Kind::log_uniform);
}

// Draws of 1 in 10 levels or less: far from uniform, near their own form.
TEST(MarginalFit, OfAGridMayBeAsWideOrNarrowAsNumbersAre) {
  const auto fit = [](double low, double high) {
    return fit_to(Vector{{low, high}}.replicate(100, 1)).likeliest();
  };
  EXPECT_NO_THROW(fit(-1e308, 1e308));
  EXPECT_NO_THROW(fit(1e-308, 1e308));
  EXPECT_NO_THROW(fit(1.0, std::nextafter(1.0, 2.0)));
}

TEST(MarginalFit, OfRoundedDrawsIsWhatTheyWereDrawnFrom) {
  const auto kind_of = [](const inference::Marginal& truth) {
    const RowMatrix theta = inference::sample_prior(inference::Prior({truth}), 1000, 1);
    return fit_to(theta.col(0).array().round()).likeliest().kind;
  };
  EXPECT_EQ(kind_of({"a", "1", Kind::uniform, 0.0, 10.0}), Kind::uniform);
  EXPECT_EQ(kind_of({"b", "1", Kind::normal, 10.0, 1.0}), Kind::normal);
}

// 15 draws of a uniform by chance look log-uniform, by 0.08 nats each: too little, unless each
// counted 100 times.
TEST(MarginalFit, DrawsThatAreThereOftenAreOneEach) {
  const Vector drawn{
      {1.53, 1.92, 1.97, 2.21, 2.29, 2.59, 2.63, 2.86, 2.96, 3.19, 3.39, 4.94, 5.07, 5.35, 5.94}};
  const Vector unrounded = (1.0 + 1e-7) * drawn;
  EXPECT_EQ(fit_to(unrounded).likeliest().kind, Kind::uniform);
  EXPECT_EQ(fit_to(unrounded.replicate(100, 1)).likeliest().kind, Kind::uniform);
}

TEST(MarginalFit, FewValuesLookUniform) {
  EXPECT_EQ(fit_to(Vector{{0.1, 1.0, 10.0}}).likeliest().kind, Kind::uniform);
  const MarginalFit constant = fit_to(Vector::Constant(5, 7.0));
  EXPECT_TRUE(constant.is_constant());
  EXPECT_EQ(constant.likeliest().a, 7.0);
}

}  // namespace
}  // namespace npdr::pipeline
