#include "pipeline/apps/marginal_fit.h"

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
    if (!truth.is_unbounded()) {
      EXPECT_EQ(found.a, theta.col(d).minCoeff());
      EXPECT_EQ(found.b, theta.col(d).maxCoeff());
      continue;
    }
    EXPECT_NEAR(found.a, truth.a, 5.0 * truth.b / std::sqrt(1000.0));
    EXPECT_NEAR(found.b, truth.b, 5.0 * truth.b / std::sqrt(2000.0));
  }
}

TEST(MarginalFit, FewValuesLookUniform) {
  EXPECT_EQ(fit_to(Vector{{0.1, 1.0, 10.0}}).likeliest().kind, Kind::uniform);
  const MarginalFit constant = fit_to(Vector::Constant(5, 7.0));
  EXPECT_TRUE(constant.is_constant());
  EXPECT_EQ(constant.likeliest().a, 7.0);
}

}  // namespace
}  // namespace npdr::pipeline
