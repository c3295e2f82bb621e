#include "inference/samplers/tempered_walkers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/constants.h"
#include "core/error.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr Index kWalkers = 2000;
constexpr Index kWalkersDimension = 3;

StreamId id(const char* name, std::uint64_t epoch) { return {1, name, 1, 0, epoch}; }

// L(u) = N(u; 1.5, 0.05^2 I): a product of D equal posteriors.
constexpr double kCentre = 1.5, kVariance = 0.0025;

Vector log_narrow_gaussian(const RowMatrix& u) {
  return -0.5 / kVariance * (u.array() - kCentre).square().rowwise().sum() -
         0.5 * static_cast<double>(kWalkersDimension) *
             std::log(2.0 * std::numbers::pi * kVariance);
}
double log_evidence() {
  const double variance = 1.0 + kVariance;
  return -0.5 * static_cast<double>(kWalkersDimension) *
         (kCentre * kCentre / variance + std::log(2.0 * std::numbers::pi * variance));
}

TemperedWalkers from_the_prior() {
  TemperedWalkers walkers{.u = RowMatrix(kWalkers, kWalkersDimension), .log_likelihood = {}};
  Stream stream(id("start", 0));
  for (double& value : walkers.u.reshaped()) value = stream.normal();
  walkers.log_likelihood = log_narrow_gaussian(walkers.u);
  return walkers;
}

void sweep(TemperedWalkers& walkers, std::uint64_t number) {
  const RowMatrix proposed = propose_steps(walkers, StepKind::wide, id("steps", number));
  take_steps(walkers, StepKind::wide, proposed, log_narrow_gaussian(proposed),
             id("choice", number));
}

// Correlation of two columns.
double correlation(const Vector& a, const Vector& b) {
  const Vector x = a.array() - a.mean(), y = b.array() - b.mean();
  return x.dot(y) / x.norm() / y.norm();
}

TEST(TemperedWalkers, ClimbToThePosteriorAndItsEvidence) {
  TemperedWalkers walkers = from_the_prior();
  std::uint64_t sweeps = 0, raises = 0;
  while (walkers.power < 1.0) {
    raise_power(walkers, next_power(walkers, 1.0, 0.5 * kWalkers), kWalkers, id("raise", ++raises));
    for (int i = 0; i < 20; ++i) sweep(walkers, ++sweeps);
  }
  // A raise at half of the walkers' worth has the standard error 1 / sqrt(W): four of all of them.
  EXPECT_GT(raises, 5u);
  EXPECT_NEAR(walkers.log_evidence, log_evidence(),
              4.0 * std::sqrt(static_cast<double>(raises) / kWalkers));
  // As good as a quarter as many independent draws, at least; five of their standard errors.
  const double variance = kVariance / (1.0 + kVariance), worth = 0.25 * kWalkers;
  const Vector mean = walkers.u.colwise().mean();
  const Eigen::MatrixXd covariance = weighted_covariance(walkers.u, Vector::Ones(kWalkers));
  for (Index d = 0; d < kWalkersDimension; ++d) {
    EXPECT_NEAR(mean(d), kCentre / (1.0 + kVariance), 5.0 * std::sqrt(variance / worth));
    EXPECT_NEAR(covariance(d, d) / variance, 1.0, 5.0 * std::sqrt(2.0 / worth));
  }
}

TEST(TemperedWalkers, KeepTheLawTheyHave) {
  // Draws of the posterior at power 1 stay that, whatever the step length has become.
  TemperedWalkers walkers = from_the_prior();
  const double variance = kVariance / (1.0 + kVariance);
  walkers.u = (walkers.u.array() * std::sqrt(variance) + kCentre / (1.0 + kVariance)).matrix();
  walkers.log_likelihood = log_narrow_gaussian(walkers.u);
  walkers.power = 1.0;
  const RowMatrix before = walkers.u;
  for (std::uint64_t i = 1; i <= 50; ++i) sweep(walkers, i);
  const Eigen::MatrixXd covariance = weighted_covariance(walkers.u, Vector::Ones(kWalkers));
  for (Index d = 0; d < kWalkersDimension; ++d) {
    EXPECT_NEAR(covariance(d, d) / variance, 1.0, 5.0 * std::sqrt(2.0 / kWalkers));
    // And they have forgotten where they were: correlations of independent draws, at 4 of their
    // standard errors, 1 / sqrt(W), and 0.2^2 to 0.05 that 50 sweeps may leave.
    EXPECT_LT(correlation(before.col(d), walkers.u.col(d)), 0.05 + 4.0 / std::sqrt(kWalkers));
  }
}

TEST(TemperedWalkers, StayWhereALikelihoodIsNoNumber) {
  TemperedWalkers walkers = from_the_prior();
  const RowMatrix before = walkers.u;
  for (const double none : {kNaN, kInfinity, -kInfinity}) {
    take_steps(walkers, StepKind::wide, propose_steps(walkers, StepKind::wide, id("steps", 1)),
               Vector::Constant(kWalkers, none), id("choice", 1));
    EXPECT_EQ(walkers.u, before);
  }
  EXPECT_LT(walkers.step_lengths[0], 1.0);
  EXPECT_EQ(walkers.step_lengths[1], 1.0);
}

// Two thin modes, at 2 and -2, one of which rises and the other of which falls:
// u_1 = +-2 + 0.002 a, u_2 = +-0.002 (a + 0.1 b) and u_3 = 0.002 c, with a, b, c ~ N(0, 1).
class ThinModes {
 public:
  static Vector log_likelihood(const RowMatrix& u) {
    const RowMatrix z = to_normal(u);
    return 0.5 * (u.rowwise().squaredNorm() - z.rowwise().squaredNorm());
  }
  static RowMatrix draws(const RowMatrix& normal) {
    RowMatrix u = 0.002 * normal;
    for (Index i = 0; i < u.rows(); ++i) {
      const double sign = i % 2 == 0 ? 1.0 : -1.0;
      u(i, 1) = sign * (u(i, 0) + 0.1 * u(i, 1));
      u(i, 0) += 2.0 * sign;
    }
    return u;
  }
  static RowMatrix to_normal(const RowMatrix& u) {
    RowMatrix z = u;
    for (Index i = 0; i < u.rows(); ++i) {
      const double sign = u(i, 0) > 0.0 ? 1.0 : -1.0;
      z(i, 0) = u(i, 0) - 2.0 * sign;
      z(i, 1) = 10.0 * (sign * u(i, 1) - z(i, 0));
    }
    return z / 0.002;
  }
};

TEST(TemperedWalkers, NeedNeighborsForNearSteps) {
  TemperedWalkers walkers = from_the_prior();
  EXPECT_THROW(propose_steps(walkers, StepKind::near, id("steps", 1)), ShapeError);
  choose_neighbors(walkers);
  raise_power(walkers, 0.1, 100, id("raise", 1));
  EXPECT_THROW(propose_steps(walkers, StepKind::near, id("steps", 1)), ShapeError);
}

TEST(TemperedWalkers, StayWhereAllNeighborsAreInOnePlace) {
  TemperedWalkers walkers = from_the_prior();
  walkers.u.rowwise() = Eigen::RowVector3d(0.1, 0.2, 0.3);
  walkers.log_likelihood = log_narrow_gaussian(walkers.u);
  choose_neighbors(walkers);
  const RowMatrix proposed = propose_steps(walkers, StepKind::near, id("steps", 1));
  EXPECT_EQ(proposed, walkers.u);
  take_steps(walkers, StepKind::near, proposed, walkers.log_likelihood, id("choice", 1));
  EXPECT_LT(walkers.step_lengths[1], 1.0) << "such steps aren't taken ones";
}

TEST(TemperedWalkers, KnowTheShapeOfTheirModeByTheirNeighbors) {
  TemperedWalkers walkers = from_the_prior();
  const RowMatrix before = walkers.u;
  walkers.u = ThinModes::draws(before);
  walkers.log_likelihood = ThinModes::log_likelihood(walkers.u);
  walkers.power = 1.0;
  for (std::uint64_t i = 1; i <= 60; ++i) {
    if (i % 6 == 1) choose_neighbors(walkers);
    const RowMatrix proposed = propose_steps(walkers, StepKind::near, id("steps", i));
    take_steps(walkers, StepKind::near, proposed, ThinModes::log_likelihood(proposed),
               id("choice", i));
  }
  const RowMatrix after = ThinModes::to_normal(walkers.u);
  const Eigen::MatrixXd covariance = weighted_covariance(after, Vector::Ones(kWalkers));
  for (Index d = 0; d < kWalkersDimension; ++d) {
    // The law is kept, within five standard errors of half as many independent draws, ...
    EXPECT_NEAR(covariance(d, d), 1.0, 5.0 * std::sqrt(4.0 / kWalkers)) << d;
    // ... and where they were is forgotten, as above.
    EXPECT_LT(correlation(before.col(d), after.col(d)), 0.05 + 4.0 / std::sqrt(kWalkers)) << d;
  }
  EXPECT_GT(walkers.step_lengths[1], 0.1);

  // As many wide steps don't: differences of all walkers are far longer than a mode is wide.
  walkers.u = ThinModes::draws(before);
  walkers.log_likelihood = ThinModes::log_likelihood(walkers.u);
  for (std::uint64_t i = 1; i <= 60; ++i) {
    const RowMatrix proposed = propose_steps(walkers, StepKind::wide, id("steps", i));
    take_steps(walkers, StepKind::wide, proposed, ThinModes::log_likelihood(proposed),
               id("choice", i));
  }
  EXPECT_GT(correlation(before.col(0), ThinModes::to_normal(walkers.u).col(0)), 0.2);
}

TEST(TemperedWalkers, TakeTheirLikelihoodsAlong) {
  TemperedWalkers walkers = from_the_prior();
  const RowMatrix before = walkers.u;
  const std::vector<Index> rows = raise_power(walkers, 0.1, 100, id("raise", 1));
  ASSERT_EQ(walkers.u.rows(), 100);
  EXPECT_EQ(walkers.u, RowMatrix(before(rows, Eigen::all)));
  EXPECT_EQ(walkers.log_likelihood, log_narrow_gaussian(walkers.u));
  EXPECT_EQ(walkers.power, 0.1);
}

}  // namespace
}  // namespace npdr::inference
