#include "inference/linear_regression/bayesian_linear_regression.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>

#include "core/error.h"
#include "tests/inference/gradient_check.h"
#include "tests/message_of.h"

namespace npdr::inference {
namespace {

struct Data {
  RowMatrix phi;
  Vector y;
};

// y = phi w + N(0, deviation^2), regressors N(0, 1) times `scale`.
Data synthetic(Index rows, const Vector& w, double deviation, const Vector& scale) {
  Data data{RowMatrix(rows, w.size()), Vector(rows)};
  for (Index i = 0; i < rows; ++i) {
    Stream stream({1, "regression_test", 0, static_cast<std::uint64_t>(i), 0});
    for (Index k = 0; k < w.size(); ++k) data.phi(i, k) = scale(k) * stream.normal();
    data.y(i) = data.phi.row(i).dot(w) + deviation * stream.normal();
  }
  return data;
}

const Vector kWeights = Eigen::Vector3d(2.0, -1.0, 0.5);

// The same by conditioning the joint Gaussian of w and y: S = C - C Phi^T (sigma^2 I + Phi C
// Phi^T)^-1 Phi C with C = I / alpha.
TEST(BayesianLinearRegression, PosteriorIsTheConditionalGaussian) {
  const Data d = synthetic(20, kWeights, 0.3, Vector::Ones(3));
  const double alpha = 0.7, beta = 5.0;
  const Eigen::MatrixXd covariance_y =
      Eigen::MatrixXd::Identity(20, 20) / beta + d.phi * d.phi.transpose() / alpha;
  const Eigen::MatrixXd gain = d.phi.transpose() / alpha * covariance_y.inverse();
  const WeightPosterior found = weight_posterior(d.phi, d.y, {alpha, beta});
  EXPECT_LT((found.mean - gain * d.y).norm(), 1e-12);
  EXPECT_LT(
      (found.covariance - (Eigen::MatrixXd::Identity(3, 3) / alpha - gain * d.phi / alpha)).norm(),
      1e-12);
}

// log p(y | alpha, beta) of columns that are scaled to a mean square of 1.
double log_evidence(const Data& d, const Precisions& p) {
  const Index n = d.y.size();
  const Eigen::RowVectorXd scale =
      (d.phi.colwise().squaredNorm() / static_cast<double>(n)).cwiseSqrt();
  const RowMatrix phi = d.phi * scale.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd covariance =
      Eigen::MatrixXd::Identity(n, n) / p.noise + phi * phi.transpose() / p.weights;
  const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
  const Eigen::MatrixXd factor = llt.matrixL();
  return -0.5 * d.y.dot(llt.solve(d.y)) - factor.diagonal().array().log().sum();
}

TEST(BayesianLinearRegression, FixedPointIsAMaximumOfTheEvidence) {
  const Data d = synthetic(40, kWeights, 1.0, Eigen::Vector3d(1.0, 100.0, 1e-3));
  const Precisions best = maximize_evidence(d.phi, d.y).precisions;
  const double log_best = log_evidence(d, best);
  for (const double factor : {0.9, 0.99, 1.01, 1.1}) {
    EXPECT_LT(log_evidence(d, {factor * best.weights, best.noise}), log_best);
    EXPECT_LT(log_evidence(d, {best.weights, factor * best.noise}), log_best);
  }
}

// The variance of N = 10,000 residuals has a relative standard error of sqrt(2 / N) = 1.4 %, the
// weights errors within S: 5 of either are exceeded once in 10^6.
TEST(BayesianLinearRegression, RecoversWeightsAndNoise) {
  const Vector scale = Eigen::Vector3d(1.0, 1e3, 1e-4);
  const Data d = synthetic(10'000, kWeights.cwiseQuotient(scale), 0.3, scale);
  const WeightPosterior found = maximize_evidence(d.phi, d.y);
  EXPECT_NEAR(1.0 / found.precisions.noise / 0.09, 1.0, 5.0 * 0.0141);
  for (Index k = 0; k < 3; ++k) {
    EXPECT_NEAR(found.mean(k), kWeights(k) / scale(k), 5.0 * std::sqrt(found.covariance(k, k)));
    // Each weight's deviation is that of noise / (scale sqrt(N)), to the 3 % of a sample variance.
    EXPECT_NEAR(std::sqrt(found.covariance(k, k)) * scale(k), 0.3 / 100.0, 0.1 * 0.003);
  }
}

TEST(BayesianLinearRegression, NoiselessDataGiveTheirWeights) {
  const Data d = synthetic(50, kWeights, 0.0, Vector::Ones(3));
  const WeightPosterior found = maximize_evidence(d.phi, d.y);
  EXPECT_LT((found.mean - kWeights).norm(), 1e-9);
  EXPECT_TRUE(found.covariance.allFinite());
}

// Means of n = 20,000 draws within 5 standard errors; entries of the covariance within 5 times
// sqrt(2 / n) of the variances.
TEST(BayesianLinearRegression, SamplesHaveThePosteriorsMoments) {
  const WeightPosterior posterior{
      kWeights, (Eigen::Matrix3d() << 4.0, 1.0, 0.0, 1.0, 1.0, 0.2, 0.0, 0.2, 0.09).finished(), {}};
  constexpr Index n = 20'000;
  const RowMatrix w = posterior.sample(n, {1, "weights", 0, 0, 0});
  const Eigen::RowVectorXd mean = w.colwise().mean();
  const RowMatrix centered = w.rowwise() - mean;
  const Eigen::MatrixXd covariance = centered.transpose() * centered / double(n);
  for (Index k = 0; k < 3; ++k) {
    const double deviation = std::sqrt(posterior.covariance(k, k));
    EXPECT_NEAR(mean(k), kWeights(k), 5.0 * deviation / std::sqrt(double(n)));
    for (Index j = 0; j < 3; ++j) {
      EXPECT_NEAR(
          covariance(k, j), posterior.covariance(k, j),
          5.0 * std::sqrt(2.0 / double(n)) * deviation * std::sqrt(posterior.covariance(j, j)));
    }
  }
  EXPECT_EQ(posterior.sample(3, {1, "weights", 0, 7, 0}), w.middleRows(7, 3));
}

TEST(BayesianLinearRegression, RejectsDataThatTellNothing) {
  EXPECT_TRUE(says(
      message_of<InputError>([] { maximize_evidence(RowMatrix::Ones(3, 3), Vector::Ones(3)); }),
      {"linear regression: 3 rows", "must be > 3"}));
  EXPECT_EQ(
      message_of<InputError>([] { maximize_evidence(RowMatrix::Ones(5, 3), Vector::Zero(5)); }),
      "linear regression: the response is 0 throughout, so it tells nothing");
  EXPECT_THROW(weight_posterior(RowMatrix::Ones(5, 3), Vector::Zero(4), {}), ShapeError);
}

// With regressors that tell nothing the evidence has its maximum at an infinite precision of the
// weights: a message, not NaN.
TEST(BayesianLinearRegression, SaysWhenRegressorsTellNothing) {
  int messages = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const RowMatrix phi = random_matrix(50, 3, 2 * seed);
    const Vector y = random_matrix(50, 1, 2 * seed + 1).col(0);
    try {
      EXPECT_TRUE(maximize_evidence(phi, y).covariance.allFinite());
    } catch (const InputError&) {
      ++messages;
    }
  }
  EXPECT_GT(messages, 0);
}

}  // namespace
}  // namespace npdr::inference
