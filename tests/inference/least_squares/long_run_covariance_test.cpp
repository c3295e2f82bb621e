#include "inference/least_squares/long_run_covariance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"

namespace npdr::inference {
namespace {

RowMatrix autoregressive(Index rows, Index cols, double rho, std::uint64_t seed) {
  Stream stream({seed, "long_run_covariance_test", 0, 0, 0});
  RowMatrix g(rows, cols);
  for (Index d = 0; d < cols; ++d) g(0, d) = stream.normal();
  for (Index t = 1; t < rows; ++t) {
    for (Index d = 0; d < cols; ++d) {
      g(t, d) = rho * g(t - 1, d) + std::sqrt(1.0 - rho * rho) * stream.normal();
    }
  }
  return g;
}

TEST(LongRunCovariance, IsTheDoubleSumWithTriangularWeights) {
  constexpr Index series = 2, steps = 20, lags = 7;
  const RowMatrix g = autoregressive(series * steps, 3, 0.5, 1);
  RowMatrix expected = RowMatrix::Zero(3, 3);
  for (Index h = 0; h < series; ++h) {
    for (Index t = 0; t < steps; ++t) {
      for (Index s = 0; s < steps; ++s) {
        const double weight =
            std::max(0.0, 1.0 - static_cast<double>(std::abs(t - s)) / double{lags});
        expected += weight * g.row(h * steps + t).transpose() * g.row(h * steps + s);
      }
    }
  }
  constexpr double c = 1.0 + 1.3289 * 0.175 + 0.1910 * 0.030625 - 0.2083 * 0.005359375;
  EXPECT_LT((long_run_covariance(g, series, lags) - c * c * expected).norm(),
            1e-10 * expected.norm());
}

// Var(sum) of an autoregression of variance 1 is about K (1 + rho) / (1 - rho). Lags for
// correlations of .97 at most would find .53 of it for .995.
TEST(LongRunCovariance, FindsTheVarianceOfASumOfAutoregressions) {
  for (const double rho : {0.0, 0.5, 0.9, 0.995}) {
    constexpr Index steps = 20'000, repetitions = 8;
    double found = 0.0;
    for (Index r = 0; r < repetitions; ++r) {
      const RowMatrix g = autoregressive(steps, 1, rho, static_cast<std::uint64_t>(r));
      found += long_run_covariance(g, 1, num_lags(g, 1))(0, 0) / double{repetitions};
    }
    const double expected = double{steps} * (1.0 + rho) / (1.0 - rho);
    EXPECT_NEAR(found / expected, 1.0, 0.25) << rho;
  }
}

TEST(LongRunCovariance, NeedsMoreLagsOfWhatLastsLonger) {
  const RowMatrix white = autoregressive(2000, 1, 0.0, 3), slow = autoregressive(2000, 1, 0.95, 3);
  EXPECT_LE(num_lags(white, 1), 6);
  EXPECT_GT(num_lags(slow, 1), 40);
  EXPECT_EQ(num_lags(RowMatrix::Zero(10, 1), 2), 1);
}

}  // namespace
}  // namespace npdr::inference
