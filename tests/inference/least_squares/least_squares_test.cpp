#include "inference/least_squares/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "core/constants.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

using Model = std::function<Vector(const Vector& u)>;  // (K) of one channel

RowMatrix draws(Index rows, Index dimension, std::uint64_t seed) {
  Stream stream({seed, "least_squares_test", 0, 0, 0});
  RowMatrix u(rows, dimension);
  for (double& each : u.reshaped<Eigen::RowMajor>()) each = stream.normal();
  return u;
}

ErrorsOf errors_of(const Vector& observed, const Model& model) {
  return [observed, model](const RowMatrix& u) {
    RowMatrixF rows(u.rows(), observed.size());
    for (Index i = 0; i < u.rows(); ++i) {
      rows.row(i) = (observed - model(u.row(i).transpose())).transpose().cast<float>();
    }
    return rows;
  };
}

LeastSquaresFit fit(const Vector& observed, const Model& model, Index dimension,
                    double smallest_scale = 1e-3, const LeastSquaresConfig& config = {}) {
  const ErrorsOf errors = errors_of(observed, model);
  const LeastSquaresProblem problem{
      errors, 1, {.smallest_scales = Vector::Constant(1, smallest_scale)}};
  return least_squares(problem, draws(100, dimension, 7), RowMatrix(0, dimension), config, 3,
                       {1, "least_squares_test", 0, 0, 0});
}

// Sums of sines: K steps, D regressors.
RowMatrix regressors(Index steps, Index dimension) {
  RowMatrix x(steps, dimension);
  for (Index t = 0; t < steps; ++t) {
    for (Index d = 0; d < dimension; ++d) {
      x(t, d) = std::sin(0.02 * static_cast<double>((d + 1) * (t + 3 * d)));
    }
  }
  return x;
}

Vector noise(Index steps, double rho, Stream& stream) {
  Vector e(steps);
  e(0) = stream.normal();
  for (Index t = 1; t < steps; ++t) {
    e(t) = rho * e(t - 1) + std::sqrt(1.0 - rho * rho) * stream.normal();
  }
  return e;
}

// With Gaussian noise of deviation s: N(A^-1 X^T y / s^2, A^-1), A = X^T X / s^2 + I. Estimates
// with Student's t of nu = 4 have 1.07 times the deviation.
TEST(LeastSquares, IsThePosteriorOfALinearModel) {
  constexpr Index steps = 400, dimension = 3;
  constexpr double s = 0.5;
  const RowMatrix x = regressors(steps, dimension);
  Eigen::MatrixXd precision = x.transpose() * x / (s * s);
  precision.diagonal().array() += 1.0;
  const Eigen::MatrixXd covariance = precision.inverse();
  Vector ratio = Vector::Zero(dimension);
  constexpr int repetitions = 20;
  for (int r = 0; r < repetitions; ++r) {
    Stream stream({static_cast<std::uint64_t>(r), "least_squares_noise", 0, 0, 0});
    const Vector y = x * Vector{{0.5, -1.0, 0.2}} + s * noise(steps, 0.0, stream);
    const LeastSquaresFit found = fit(
        y, [&](const Vector& u) -> Vector { return x * u; }, 3);
    ASSERT_EQ(found.minima.size(), 1U);
    const Minimum& minimum = found.minima.front();
    EXPECT_TRUE(found.converged);
    const Vector expected = covariance * x.transpose() * y / (s * s);
    // The two estimates differ by a third of a deviation.
    for (Index d = 0; d < dimension; ++d) {
      EXPECT_NEAR(minimum.u(d), expected(d), 1.5 * std::sqrt(covariance(d, d)));
      ratio(d) += std::sqrt(minimum.covariance(d, d) / covariance(d, d)) / repetitions;
    }
  }
  for (const double each : ratio) EXPECT_NEAR(each, 1.07, 0.1);
}

// 90 % intervals of 150 fits of two parameters each (standard error .02). They hold .87, .83 and
// .81: how long noise lasts is estimated from the same few errors.
TEST(LeastSquares, IntervalsHoldTheTruthWhereErrorsLast) {
  constexpr Index steps = 500;
  const RowMatrix x = regressors(steps, 2);
  const Vector truth{{0.3, -0.4}};
  for (const double rho : {0.0, 0.8, 0.95}) {
    int held = 0;
    constexpr int repetitions = 150;
    for (int r = 0; r < repetitions; ++r) {
      Stream stream({static_cast<std::uint64_t>(r), "least_squares_lasting", 0, 0, 0});
      const Vector y = x * truth + 0.4 * noise(steps, rho, stream);
      const LeastSquaresFit found = fit(
          y, [&](const Vector& u) -> Vector { return x * u; }, 2);
      const Minimum& minimum = found.minima.front();
      for (Index d = 0; d < 2; ++d) {
        held += std::abs(minimum.u(d) - truth(d)) < 1.645 * std::sqrt(minimum.covariance(d, d));
      }
    }
    EXPECT_GT(held / (2.0 * repetitions), 0.75) << rho;
    EXPECT_LT(held / (2.0 * repetitions), 0.96) << rho;
  }
}

TEST(LeastSquares, EqualMinimaWeighTheSame) {
  const RowMatrix x = regressors(200, 1);
  Stream stream({1, "least_squares_minima", 0, 0, 0});
  const Vector y = x * Vector{{0.8}} + 0.1 * noise(200, 0.0, stream);
  const LeastSquaresFit found = fit(
      y, [&](const Vector& u) -> Vector { return x * u.cwiseAbs2(); }, 1);
  ASSERT_EQ(found.minima.size(), 2U);
  EXPECT_NEAR(std::abs(found.minima[0].u(0)), std::sqrt(0.8), 0.05);
  EXPECT_NEAR(found.minima[0].u(0), -found.minima[1].u(0), 1e-2);
  EXPECT_NEAR(found.minima[0].weight, 0.5, 0.05);
  const RowMatrix samples = found.sample(400, {1, "least_squares_samples", 0, 0, 0});
  EXPECT_NEAR((samples.array() > 0.0).cast<double>().mean(), 0.5, 0.1);
}

// A tenth of the errors are a hundred times as large.
TEST(LeastSquares, OutliersHardlyMoveIt) {
  const RowMatrix x = regressors(300, 2);
  Stream stream({2, "least_squares_outliers", 0, 0, 0});
  Vector y = x * Vector{{0.5, 0.5}} + 0.05 * noise(300, 0.0, stream);
  for (Index t = 0; t < y.size(); t += 10) y(t) += 5.0;
  const LeastSquaresFit found = fit(
      y, [&](const Vector& u) -> Vector { return x * u; }, 2);
  EXPECT_NEAR(found.minima.front().u(0), 0.5, 0.03);
  EXPECT_NEAR(found.minima.front().u(1), 0.5, 0.03);
}

TEST(LeastSquares, WhatNothingTellsKeepsItsPrior) {
  const RowMatrix x = regressors(200, 1);
  Stream stream({3, "least_squares_open", 0, 0, 0});
  const Vector y = x * Vector{{0.5}} + 0.1 * noise(200, 0.0, stream);
  const LeastSquaresFit found = fit(
      y, [&](const Vector& u) -> Vector { return x * u.head(1); }, 2);
  const Minimum& minimum = found.minima.front();
  EXPECT_LT(minimum.covariance(0, 0), 1e-3);
  EXPECT_NEAR(minimum.covariance(1, 1), 1.0, 1e-3);
  EXPECT_NEAR(minimum.u(1), 0.0, 1e-2);
}

TEST(LeastSquares, FindsItsWayAroundWhatCannotBeSimulated) {
  const RowMatrix x = regressors(200, 2);
  const Vector y = x * Vector{{0.5, 0.7}};
  const auto half = [&](const Vector& u) -> Vector {
    if (u(0) < 0.3) return Vector::Constant(200, kNaN);
    return x * u;
  };
  const LeastSquaresFit found = fit(y, half, 2);
  EXPECT_GT(found.num_failed, 0);
  EXPECT_NEAR(found.minima.front().u(0), 0.5, 1e-3);
  const LeastSquaresFit none = fit(
      y, [](const Vector&) -> Vector { return Vector::Constant(200, kNaN); }, 2);
  EXPECT_TRUE(none.minima.empty());
  EXPECT_EQ(none.num_failed, none.num_rows);
}

// Half of them are candidates at most; a start needs 34 for six steps, and 9 for one.
TEST(LeastSquares, StopsWithinItsSimulations) {
  const RowMatrix x = regressors(100, 2);
  const Vector y = x * Vector{{0.5, 0.7}};
  const auto within = [&](Index most) {
    return fit(y, [&](const Vector& u) -> Vector { return x * u; }, 2, 1e-3,
               {.max_simulations = most});
  };
  EXPECT_LE(within(150).num_rows, 150);
  EXPECT_TRUE(within(150).converged);
  EXPECT_LE(within(12).num_rows, 12);
  EXPECT_FALSE(within(12).converged);
  EXPECT_FALSE(within(12).minima.empty());
}

// y = X u + Z b + e with b of each block its own: N(P^-1 X^T S^-1 y, P^-1), S = s^2 I + Z Z^T,
// P = X^T S^-1 X + I. Both channels see both unknowns of a block, for less and less.
TEST(LeastSquares, UnknownsOfBlocksAreEliminated) {
  constexpr Index rollouts = 4, steps = 60, channels = 2, dimension = 3;
  const std::vector<Index> begins = {0, 25, 40};
  const auto num_blocks = rollouts * std::ssize(begins);
  constexpr double s = 0.2;
  const RowMatrix x = regressors(rollouts * steps * channels, dimension);
  RowMatrix z = RowMatrix::Zero(x.rows(), num_blocks * channels);
  for (Index i = 0; i < rollouts * steps; ++i) {
    const Index step = i % steps, block = step < 25 ? 0 : step < 40 ? 1 : 2;
    const Index own = (i / steps * std::ssize(begins) + block) * channels;
    const double share = std::exp(-0.1 * static_cast<double>(step - begins[block]));
    z.block(i * channels, own, channels, channels) =
        share * Eigen::Matrix2d{{1.0, 0.5}, {-0.5, 1.0}};
  }
  Eigen::MatrixXd covariance = z * z.transpose();
  covariance.diagonal().array() += s * s;
  const Eigen::MatrixXd weighted = x.transpose() * covariance.inverse();
  Eigen::MatrixXd precision = weighted * x;
  precision.diagonal().array() += 1.0;
  const Eigen::MatrixXd expected = precision.inverse();
  const Vector truth{{0.5, -1.0, 0.2}};
  double distance = 0.0, ratio = 0.0;
  constexpr int repetitions = 20;
  for (int r = 0; r < repetitions; ++r) {
    Stream stream({static_cast<std::uint64_t>(r), "least_squares_blocks", 0, 0, 0});
    const Vector y =
        x * truth + z * noise(z.cols(), 0.0, stream) + s * noise(x.rows(), 0.0, stream);
    const ErrorsOf errors = errors_of(y, [&](const Vector& unknowns) -> Vector {
      return x * unknowns.head(dimension) + z * unknowns.tail(z.cols());
    });
    const LeastSquaresProblem problem{
        errors, rollouts, {.smallest_scales = Vector::Constant(channels, 1e-3)}, {}, begins};
    const LeastSquaresFit found = least_squares(problem, draws(50, dimension, 7), RowMatrix(0, 3),
                                                {}, 1, {1, "least_squares_test", 0, 0, 0});
    ASSERT_EQ(found.minima.size(), 1U);
    EXPECT_TRUE(found.converged);
    const Minimum& minimum = found.minima.front();
    const Vector off = minimum.u - expected * weighted * y;
    distance += off.dot(precision * off) / (dimension * repetitions);
    ratio += (precision * minimum.covariance).trace() / (dimension * repetitions);
  }
  EXPECT_LT(distance, 0.4);  // Student's t instead of Gaussian errors: .12 in the mean
  EXPECT_NEAR(ratio, 1.15, 0.25);
}

// Only u_0 + 1.3 u_1 is known, and simulations are rounded to float: 30,000 values of deviation
// 1e-4 tell it to 1e-6.
TEST(LeastSquares, RoundingIsNoInformation) {
  constexpr Index steps = 30'000;
  const RowMatrix x = regressors(steps, 1);
  const auto model = [&](const Vector& u) -> Vector { return x * std::exp(u(0) + 1.3 * u(1)); };
  Stream stream({4, "least_squares_rounding", 0, 0, 0});
  const Vector y = model(Vector{{0.2, -0.3}}) + 1e-4 * noise(steps, 0.0, stream);
  const ErrorsOf errors = [&](const RowMatrix& u) {
    RowMatrixF rows(u.rows(), steps);
    for (Index i = 0; i < u.rows(); ++i) {
      const VectorF simulated = model(u.row(i).transpose()).cast<float>();
      rows.row(i) = (y - simulated.cast<double>()).cast<float>().transpose();
    }
    return rows;
  };
  const LeastSquaresProblem problem{
      errors, 1, {.smallest_scales = Vector::Constant(1, 1e-5)}, Vector::Constant(1, 3e-8)};
  const LeastSquaresFit found = least_squares(problem, draws(50, 2, 7), RowMatrix(0, 2), {}, 2,
                                              {1, "least_squares_test", 0, 0, 0});
  const RowMatrix& covariance = found.minima.front().covariance;
  const Vector known = Vector{{1.0, 1.3}}.normalized(), open{{known(1), -known(0)}};
  EXPECT_NEAR(open.dot(covariance * open), 1.0, 0.2);
  EXPECT_LT(known.dot(covariance * known), 1e-10);
}

}  // namespace
}  // namespace npdr::inference
