#include "inference/pareto_tail.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

TEST(ParetoTail, FindsTheShapeOfTheTail) {
  // w = U^-k has the tail shape k. Its estimate from 3 sqrt(n) = 424 weights has standard error
  // (1 + k) / sqrt(424) = 0.08 at most; the prior draws it to 0.5 by 10 of 434 weights' worth.
  Stream stream({1, "start", 0, 0, 0});
  for (const double k : {0.2, 0.5, 1.0}) {
    Vector weights(20'000);
    for (double& weight : weights) weight = std::pow(stream.uniform(), -k);
    EXPECT_NEAR(pareto_k(weights), k, 4.0 * (1.0 + k) / std::sqrt(424.0));
  }
}

// y = scale (U^-k - 1) / k. Of 2000, the standard errors of k and scale are (1 + k) / sqrt(2000)
// and scale sqrt(2 (1 + k) / 2000) (Smith 1987); a hundredth exceeds (100^k - 1) scale / k.
TEST(ParetoTail, FindsShapeAndScaleOfExcesses) {
  Stream stream({1, "excess", 0, 0, 0});
  const double k = 0.5, scale = 3.0;
  Vector excess(2000);
  for (double& y : excess) y = scale * (std::pow(stream.uniform(), -k) - 1.0) / k;
  std::ranges::sort(excess);
  const ParetoTail tail = fit_pareto_tail(excess);
  EXPECT_NEAR(tail.k, k, 4.0 * (1.0 + k) / std::sqrt(2000.0));
  EXPECT_NEAR(tail.scale, scale, 4.0 * scale * std::sqrt(2.0 * (1.0 + k) / 2000.0));
  const double y = scale * (std::pow(100.0, k) - 1.0) / k;
  EXPECT_NEAR(ParetoTail({k, scale}).probability_beyond(y), 0.01, 1e-12);
  EXPECT_NEAR(ParetoTail({0.0, scale}).probability_beyond(y), std::exp(-y / scale), 1e-12);
}

TEST(ParetoTail, OfFewExcesses) {
  for (const Index count : {1, 2, 3}) {
    const ParetoTail tail = fit_pareto_tail(Vector::LinSpaced(count, 1.0, 2.0));
    EXPECT_TRUE(std::isfinite(tail.k) && tail.scale > 0.0) << count;
  }
}

TEST(ParetoTail, OfWeightsThatTellNothing) {
  EXPECT_EQ(pareto_k(Vector::Ones(10)), kInfinity);
  EXPECT_EQ(pareto_k(Vector::Zero(1000)), kInfinity);
  EXPECT_EQ(pareto_k(Vector::Ones(1000)), -kInfinity);
  Vector rounded = Vector::Ones(1000);
  rounded.head(500).array() += std::numeric_limits<double>::epsilon();
  EXPECT_EQ(pareto_k(rounded), -kInfinity) << "but for rounding";
}

}  // namespace
}  // namespace npdr::inference
