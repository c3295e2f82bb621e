#include "inference/policy_search/policy_optimizer.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "inference/policy_search/exploration.h"
#include "tests/message_of.h"

namespace npdr::inference {
namespace {

// A return shaped like a Gaussian in 7-D with a correlated Hessian: its ridge is 20 times as long
// as it is wide, along no axis.
class CorrelatedReturn {
 public:
  CorrelatedReturn() {
    const RowMatrix axes =
        draw_gaussian(Vector::Zero(7), RowMatrix::Identity(7, 7), 7, {5, "axes"});
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(axes + axes.transpose());
    const Vector widths = Vector::LinSpaced(7, 0.25, 5.0);
    hessian_ = eigen.eigenvectors() * widths.cwiseAbs2().cwiseInverse().asDiagonal() *
               eigen.eigenvectors().transpose();
  }
  double at(const Vector& policy) const {
    const Vector step = policy - optimum();
    return 1250.0 * std::exp(-0.5 * step.dot(hessian_ * step));
  }
  Vector of(const RowMatrix& policies) const {
    Vector returns(policies.rows());
    for (Index i = 0; i < returns.size(); ++i) returns(i) = at(policies.row(i).transpose());
    return returns;
  }
  static Vector optimum() { return Vector{{1.0, -2.0, 0.5, 3.0, -1.0, 0.0, 2.0}}; }

 private:
  Eigen::MatrixXd hessian_;
};

StreamId of_seed(std::uint64_t seed) { return {seed, "test"}; }

void iterate(PolicyOptimizer& optimizer, const CorrelatedReturn& objective, Index times,
             std::uint64_t seed) {
  for (Index i = 0; i < times; ++i) {
    const RowMatrix policies = optimizer.ask(of_seed(seed));
    optimizer.tell(policies, objective.of(policies));
  }
}

PolicySearchConfig config_of(PolicyOptimizerKind kind) { return {.kind = kind}; }

Vector standard_deviations(const PolicySearchState& state) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(state.covariance);
  return eigen.eigenvalues().cwiseSqrt();
}

std::string problem_of(const PolicySearchConfig& config) {
  return message_of<InputError>([&] { make_policy_optimizer(config, Vector::Zero(3)); });
}

class EveryOptimizer : public testing::TestWithParam<PolicyOptimizerKind> {};
INSTANTIATE_TEST_SUITE_P(PolicySearch, EveryOptimizer,
                         testing::Values(PolicyOptimizerKind::power,
                                         PolicyOptimizerKind::cross_entropy));

TEST_P(EveryOptimizer, FindsTheOptimumOfACorrelatedReturn) {
  const CorrelatedReturn objective;
  PolicySearchConfig config = config_of(GetParam());
  config.population = 200;  // few candidates may shrink the exploration before they are there
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto optimizer = make_policy_optimizer(config, Vector(Vector::Zero(7)));
    const double before = objective.at(optimizer->current());
    ASSERT_LT(before, 100.0);
    iterate(*optimizer, objective, 60, seed);
    EXPECT_GT(objective.at(optimizer->current()), 0.97 * 1250.0) << "seed " << seed;
    EXPECT_GE(optimizer->state().best_returns(0), objective.at(optimizer->current()) * 0.99);
    EXPECT_LT(standard_deviations(optimizer->state()).minCoeff(), 0.2) << "seed " << seed;
  }
}

TEST_P(EveryOptimizer, AsksForTheCurrentPolicyAndForDrawsAroundIt) {
  PolicySearchConfig config = config_of(GetParam());
  config.population = 4000;
  const Vector initial{{1.0, -3.0}};
  const auto optimizer = make_policy_optimizer(config, initial);
  const RowMatrix policies = optimizer->ask(of_seed(1));
  ASSERT_EQ(policies.rows(), 4001);
  EXPECT_EQ(policies.row(0).transpose(), initial);
  const RowMatrix draws = policies.bottomRows(4000);
  // Five standard errors of a mean, 2 / sqrt(4000), and of a variance, 4 sqrt(2 / 4000), or of a
  // covariance, 4 / sqrt(4000): false alarm 3e-6 in all.
  EXPECT_LT((draws.colwise().mean().transpose() - initial).cwiseAbs().maxCoeff(), 0.159);
  const RowMatrix covariance = scatter_around(initial, draws, Vector::Ones(4000));
  EXPECT_NEAR(covariance(0, 0), 4.0, 0.45);
  EXPECT_NEAR(covariance(1, 1), 4.0, 0.45);
  EXPECT_NEAR(covariance(0, 1), 0.0, 0.32);
}

TEST_P(EveryOptimizer, CandidatesAreAFunctionOfSeedIterationAndNumber) {
  PolicySearchConfig config = config_of(GetParam());
  const auto optimizer = make_policy_optimizer(config, Vector(Vector::Zero(7)));
  const RowMatrix first = optimizer->ask(of_seed(1));
  EXPECT_EQ(optimizer->ask(of_seed(1)), first);
  EXPECT_NE(optimizer->ask(of_seed(2)), first);
  config.population = 30;
  const auto larger = make_policy_optimizer(config, Vector(Vector::Zero(7)));
  EXPECT_EQ(larger->ask(of_seed(1)).topRows(26), first);
  PolicySearchState later = optimizer->state();
  later.iteration = 1;
  EXPECT_NE(make_policy_optimizer(config_of(GetParam()), later)->ask(of_seed(1)), first);
}

TEST_P(EveryOptimizer, StoredStateGoesOnWithTheSameBits) {
  const CorrelatedReturn objective;
  const auto whole = make_policy_optimizer(config_of(GetParam()), Vector(Vector::Zero(7)));
  iterate(*whole, objective, 5, 1);
  const PolicySearchState stored = whole->state();
  iterate(*whole, objective, 5, 1);
  const auto resumed = make_policy_optimizer(config_of(GetParam()), stored);
  iterate(*resumed, objective, 5, 1);
  EXPECT_EQ(resumed->state().iteration, 10);
  EXPECT_EQ(resumed->state().mean, whole->state().mean);
  EXPECT_EQ(resumed->state().covariance, whole->state().covariance);
  EXPECT_EQ(resumed->state().best_policies, whole->state().best_policies);
  EXPECT_EQ(resumed->state().best_returns, whole->state().best_returns);
}

TEST_P(EveryOptimizer, ExplorationNeverFallsBelowItsLowerBound) {
  PolicySearchConfig config = config_of(GetParam());
  config.population = 5;  // spans fewer than the 7 dimensions
  config.min_std = 0.3;
  const CorrelatedReturn objective;
  const auto optimizer = make_policy_optimizer(config, Vector(Vector::Zero(7)));
  double smallest = 2.0;
  for (int i = 0; i < 40; ++i) {
    iterate(*optimizer, objective, 1, 1);
    smallest = std::min(smallest, standard_deviations(optimizer->state()).minCoeff());
  }
  EXPECT_NEAR(smallest, 0.3, 1e-9);
}

TEST_P(EveryOptimizer, RemembersTheBestPolicyOfAllIterations) {
  const auto optimizer = make_policy_optimizer(config_of(GetParam()), Vector(Vector::Zero(2)));
  const RowMatrix first = optimizer->ask(of_seed(1));
  Vector returns = Vector::Zero(26);
  returns(7) = 100.0;
  optimizer->tell(first, returns);
  const RowMatrix second = optimizer->ask(of_seed(1));
  optimizer->tell(second, Vector::Constant(26, 1.0));
  EXPECT_EQ(optimizer->state().best_returns(0), 100.0);
  EXPECT_EQ(optimizer->state().best_policies.row(0), first.row(7));
}

TEST_P(EveryOptimizer, WhatDoesntFitIsAnError) {
  const auto optimizer = make_policy_optimizer(config_of(GetParam()), Vector(Vector::Zero(3)));
  const RowMatrix policies = optimizer->ask(of_seed(1));
  const Vector returns = Vector::Ones(26);
  EXPECT_THROW(optimizer->tell(policies.topRows(25), returns.head(25)), ShapeError);
  EXPECT_THROW(optimizer->tell(policies.leftCols(2), returns), ShapeError);
  EXPECT_THROW(optimizer->tell(policies, returns.head(25)), ShapeError);
  Vector bad = returns;
  bad(3) = kNaN;
  EXPECT_THROW(optimizer->tell(policies, bad), InputError);
  EXPECT_EQ(optimizer->state().iteration, 0);
  PolicySearchState state = optimizer->state();
  state.covariance.resize(2, 2);
  EXPECT_THROW(make_policy_optimizer(config_of(GetParam()), state), ShapeError);
}

TEST(PolicyOptimizer, ConfigOutOfRangeIsAnError) {
  EXPECT_EQ(problem_of({.kind = PolicyOptimizerKind::none}),
            "policy.optimizer = '', must be one of power, cross_entropy");
  EXPECT_EQ(problem_of({.population = 0}), "policy.population = 0, must be >= 1");
  EXPECT_TRUE(says(problem_of({.kind = PolicyOptimizerKind::cross_entropy, .population = 1}),
                   {"policy.population = 1", "must be >= 2 with 'cross_entropy'"}));
  EXPECT_EQ(problem_of({.num_iterations = 0}), "policy.num_iterations = 0, must be >= 1");
  EXPECT_EQ(problem_of({.initial_std = -1.0}), "policy.initial_std = -1, must be > 0");
  EXPECT_TRUE(says(problem_of({.min_std = 3.0}),
                   {"policy.min_std = 3", "must be > 0 and <= initial_std = 2"}));
  EXPECT_TRUE(says(problem_of({.num_importance_samples = 0}),
                   {"policy.num_importance_samples = 0", "must be >= 1"}));
  EXPECT_EQ(problem_of({.min_return = 0.0}), "policy.min_return = 0, must be > 0");
  EXPECT_TRUE(says(problem_of({.elite_fraction = 1.5}),
                   {"policy.elite_fraction = 1.5", "must be in (0, 1]"}));
  EXPECT_EQ(problem_of({.smoothing = 0.0}), "policy.smoothing = 0, must be in (0, 1]");
  Vector initial = Vector::Zero(3);
  initial(1) = kInfinity;
  EXPECT_THROW(make_policy_optimizer({}, initial), InputError);
}

TEST(Exploration, LowerBoundLeavesWideDirectionsAlone) {
  // Along (1, 1) variance 2, along (1, -1) 0.02.
  const RowMatrix narrow{{1.01, 0.99}, {0.99, 1.01}};
  EXPECT_LT((with_min_std(narrow, 0.1) - narrow).cwiseAbs().maxCoeff(), 1e-15);
  const RowMatrix bounded{{1.125, 0.875}, {0.875, 1.125}};  // 2 and 0.25
  EXPECT_LT((with_min_std(narrow, 0.5) - bounded).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace npdr::inference
