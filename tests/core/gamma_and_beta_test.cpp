#include "core/gamma_and_beta.h"

#include <gtest/gtest.h>

#include <cmath>

namespace npdr {
namespace {

constexpr double kShapes[] = {0.1, 0.5, 1.0, 2.5, 30.0, 1000.0};

// P(X > x) = exp(-x) sum_{i < k} x^i / i!, and P(X > x) = sum_{i < a} binom(n, i) x^i (1 - x)^(n -
// i) with n = a + b - 1.
TEST(GammaAndBeta, TailsOfWholeShapesAreSums) {
  for (const double x : {0.01, 0.4, 0.9}) {
    double term = std::exp(-5.0 * x), sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      sum += term;
      term *= 5.0 * x / (i + 1.0);
    }
    EXPECT_NEAR(gamma_tail(4.0, 5.0 * x, Tail::upper) / sum, 1.0, 1e-13);
    term = std::pow(1.0 - x, 6.0);
    sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      sum += term;
      term *= x / (1.0 - x) * (6.0 - i) / (i + 1.0);
    }
    EXPECT_NEAR(beta_tail(3.0, 4.0, x, Tail::upper) / sum, 1.0, 1e-13);
    EXPECT_NEAR(beta_tail(3.0, 4.0, x, Tail::lower), 1.0 - sum, 1e-14);
  }
}

TEST(GammaAndBeta, QuantilesHaveTheirTails) {
  for (const Tail tail : {Tail::lower, Tail::upper}) {
    for (const double a : kShapes) {
      for (const double p : {1.1e-16, 1e-6, 0.1, 0.5, 0.9}) {
        EXPECT_NEAR(gamma_tail(a, gamma_quantile(a, p, tail), tail) / p, 1.0, 1e-9)
            << a << " " << p;
        for (const double b : kShapes) {
          const double x = beta_quantile(a, b, p, tail);
          if (x > 1.0 - 1e-6) continue;  // doubles near 1 are too far apart
          EXPECT_NEAR(beta_tail(a, b, x, tail) / p, 1.0, 1e-9) << a << " " << b << " " << p;
        }
      }
    }
  }
}

}  // namespace
}  // namespace npdr
