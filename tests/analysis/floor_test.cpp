#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "analysis/differential_evolution.h"
#include "analysis/floor.h"
#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// An objective for points (n, D) from one for a single point.
template <typename Function>
BatchObjective rowwise(const Function& function) {
  return [function](const RowMatrix& points) {
    Vector values(points.rows());
    for (Index i = 0; i < points.rows(); ++i) values(i) = function(Vector(points.row(i)));
    return values;
  };
}

// Rastrigin (1974), moved: a local minimum near every point of a lattice, the global one 0 at 1.3.
double rastrigin(const Vector& theta) {
  double sum = 0.0;
  for (const double t : theta) {
    sum += (t - 1.3) * (t - 1.3) + 10.0 - 10.0 * std::cos(kTwoPi * (t - 1.3));
  }
  return sum;
}

// Rosenbrock (1960): a bent valley, minimum 0 at 1.
double rosenbrock(const Vector& theta) {
  double sum = 0.0;
  for (Index d = 0; d + 1 < theta.size(); ++d) {
    sum += 100.0 * std::pow(theta(d + 1) - theta(d) * theta(d), 2) + std::pow(1.0 - theta(d), 2);
  }
  return sum;
}

FloorResult find_in_cube(const BatchObjective& objective, Index dimension, double bound,
                         const FloorConfig& config = {}) {
  return find_floor(objective, Vector::Constant(dimension, -bound),
                    Vector::Constant(dimension, bound), RowMatrix(), config);
}

TEST(Floor, FindsTheGlobalMinimumAmongManyLocalOnes) {
  const FloorResult result = find_in_cube(rowwise(rastrigin), 8, 5.12);
  EXPECT_NEAR(result.value, 0.0, 1e-9);
  for (const double t : result.theta) EXPECT_NEAR(t, 1.3, 1e-5);
  EXPECT_LT(result.restart_values.maxCoeff(), 1e-9);
  EXPECT_NEAR(find_in_cube(rowwise(rastrigin), 1, 5.12).theta(0), 1.3, 1e-6);
  FloorConfig config;
  config.max_generations = 400;
  EXPECT_NEAR(find_in_cube(rowwise(rosenbrock), 6, 2.0, config).value, 0.0, 1e-8);
}

// Ranges as different as those of the Furuta pendulum, a valley that couples neighbors, and the
// unconstrained minimum outside the box in the first, third and fifth parameter.
TEST(Floor, FindsAMinimumOnSeveralBoundsExactly) {
  Vector lower(6), upper(6);
  lower << 0.0, 0.0, 2.52, 0.0126, 0.066, 8.34;
  upper << 1e-3, 1e-5, 14.28, 0.0714, 0.12, 11.28;
  const auto objective = rowwise([&](const Vector& theta) {
    const Vector u = (theta - lower).cwiseQuotient(upper - lower);
    Vector center(6);
    center << -0.5, 0.3, 1.4, 0.8, 1.2, 0.4;
    const Vector e = u - center;
    double sum = e.squaredNorm();
    for (Index d = 0; d + 1 < 6; ++d) sum += 0.2 * e(d) * e(d + 1);
    return 0.3 + sum;
  });
  const FloorResult result = find_floor(objective, lower, upper, RowMatrix());
  EXPECT_EQ(result.theta(0), lower(0));
  EXPECT_EQ(result.theta(2), upper(2));
  EXPECT_EQ(result.theta(4), upper(4));
  // With e1 = 0.5, e3 = -0.4, e5 = -0.2 the free ones follow from zero derivatives:
  // 2 e_d + 0.2 (e_{d-1} + e_{d+1}) = 0.
  const double e2 = -0.1 * (0.5 - 0.4), e4 = -0.1 * (-0.4 - 0.2), e6 = -0.1 * -0.2;
  EXPECT_NEAR(result.theta(1) / upper(1), 0.3 + e2, 1e-5);
  const double expected = 0.3 + 0.25 + 0.16 + 0.04 + e2 * e2 + e4 * e4 + e6 * e6 +
                          0.2 * (0.5 * e2 - 0.4 * e2 - 0.4 * e4 - 0.2 * e4 - 0.2 * e6);
  EXPECT_NEAR(result.value, expected, 1e-10);
}

// Half of the box gives NaN or infinity, and the minimum lies on the edge of that half.
TEST(Floor, AvoidsPointsWhereTheObjectiveIsNotFinite) {
  const auto objective = rowwise([](const Vector& theta) {
    if (theta(0) < 0.0) return theta(1) < 0.0 ? kNaN : -kInfinity;
    return (theta.array() + 1.0).square().sum();
  });
  const FloorResult result = find_in_cube(objective, 3, 2.0);
  EXPECT_NEAR(result.value, 1.0, 1e-5);
  EXPECT_GE(result.theta(0), 0.0);
}

TEST(Floor, IsNeverAboveTheBestStartingPoint) {
  // A hole of width 1e-3 that no search would find by itself.
  const auto objective = rowwise([](const Vector& theta) {
    return (theta.array() - 0.7).matrix().norm() < 1e-3 ? -1.0 : 1.0;
  });
  RowMatrix start = RowMatrix::Zero(2, 5);
  start.row(1).setConstant(0.7);
  const FloorResult result = find_floor(objective, Vector::Zero(5), Vector::Ones(5), start);
  EXPECT_EQ(result.value, -1.0);
  EXPECT_EQ(result.restart_values(1), 1.0);
}

TEST(Floor, HasTheSameBitsForTheSameSeedAndOthersForAnother) {
  FloorConfig config;
  config.max_generations = 20;
  config.num_restarts = 2;
  config.seed = 4;
  const FloorResult a = find_in_cube(rowwise(rastrigin), 4, 5.12, config);
  const FloorResult b = find_in_cube(rowwise(rastrigin), 4, 5.12, config);
  EXPECT_EQ(a.theta, b.theta);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.num_evaluations, b.num_evaluations);
  config.seed = 5;
  EXPECT_NE(find_in_cube(rowwise(rastrigin), 4, 5.12, config).theta, a.theta);
}

TEST(Floor, AsksForWholePopulationsAndCountsItsQuestions) {
  Index points = 0, batches = 0;
  const BatchObjective objective = [&](const RowMatrix& theta) -> Vector {
    points += theta.rows();
    batches += theta.rows() == 128;
    return theta.rowwise().sum();
  };
  FloorConfig config;
  config.max_generations = 10;
  const FloorResult result = find_in_cube(objective, 3, 1.0, config);
  EXPECT_EQ(batches, 3 * 11);
  EXPECT_EQ(result.num_evaluations, points);
  EXPECT_EQ(result.value, -3.0);
}

TEST(Floor, PassesOnWhatTheObjectiveThrowsAndRejectsWhatItMiscounts) {
  // The population is fine; the first single point of the local search is not.
  const BatchObjective objective = [](const RowMatrix& theta) -> Vector {
    if (theta.rows() == 1) throw std::out_of_range("simulator");
    return theta.rowwise().sum();
  };
  EXPECT_THROW(find_in_cube(objective, 2, 1.0), std::out_of_range);
  FloorConfig config;
  config.max_generations = 2;
  EXPECT_THROW(find_in_cube(rowwise([](const Vector&) { return kNaN; }), 2, 1.0, config), Error);
  EXPECT_THROW(find_in_cube([](const RowMatrix&) { return Vector::Zero(1); }, 2, 1.0), ShapeError);
}

TEST(Floor, RejectsBadBoxesStartsAndConfigs) {
  const auto objective = rowwise(rastrigin);
  const Vector zero = Vector::Zero(2), one = Vector::Ones(2);
  const auto find = [&](const Vector& lower, const Vector& upper, const RowMatrix& start = {}) {
    find_floor(objective, lower, upper, start);
  };
  EXPECT_THROW(find(zero, Vector::Ones(3)), ShapeError);
  EXPECT_THROW(find(Vector(), Vector()), ShapeError);
  EXPECT_THROW(find(one, zero), InputError);
  EXPECT_THROW(find(zero, Vector::Constant(2, kNaN)), InputError);
  EXPECT_THROW(find(zero, one, RowMatrix::Zero(1, 3)), ShapeError);
  for (const double start : {1.5, kNaN}) {
    EXPECT_THROW(find(zero, one, RowMatrix::Constant(1, 2, start)), InputError);
  }
  for (const auto& spoil : std::vector<void (*)(FloorConfig&)>{
           [](FloorConfig& c) { c.num_restarts = 0; }, [](FloorConfig& c) { c.population = 3; },
           [](FloorConfig& c) { c.max_generations = -1; },
           [](FloorConfig& c) { c.global_tolerance = kNaN; },
           [](FloorConfig& c) { c.max_local_evaluations = 0; },
           [](FloorConfig& c) { c.local_step = 0.6; },
           [](FloorConfig& c) { c.local_tolerance = 0.0; }}) {
    FloorConfig config;
    spoil(config);
    EXPECT_THROW(find_floor(objective, zero, one, RowMatrix(), config), InputError);
  }
}

Vector sphere(const RowMatrix& points) {
  Vector values(points.rows());
  for (Index i = 0; i < points.rows(); ++i)
    values(i) = (points.row(i).array() - 0.4).square().sum();
  return values;
}

TEST(DifferentialEvolution, FirstPopulationHasOnePointInEverySlice) {
  DifferentialEvolutionConfig config;
  config.population = 10;
  config.max_generations = 0;
  const auto result = differential_evolution(sphere, 3, RowMatrix(), config);
  EXPECT_EQ(result.num_evaluations, 10);
  for (Index d = 0; d < 3; ++d) {
    std::vector<int> slices;
    for (Index i = 0; i < 10; ++i) slices.push_back(static_cast<int>(10.0 * result.points(i, d)));
    std::sort(slices.begin(), slices.end());
    for (int k = 0; k < 10; ++k) EXPECT_EQ(slices[static_cast<std::size_t>(k)], k);
  }
}

TEST(DifferentialEvolution, StaysInTheCubeAndReturnsTheBestFirst) {
  DifferentialEvolutionConfig config;
  config.population = 20;
  config.max_generations = 15;
  const BatchObjective objective = [](const RowMatrix& points) {
    EXPECT_GE(points.minCoeff(), 0.0);
    EXPECT_LE(points.maxCoeff(), 1.0);
    return sphere(points);
  };
  const auto result = differential_evolution(objective, 4, RowMatrix(), config);
  EXPECT_TRUE(std::is_sorted(result.values.begin(), result.values.end()));
  EXPECT_EQ(sphere(result.points), result.values);
}

TEST(DifferentialEvolution, StopsWhenThePopulationAgrees) {
  DifferentialEvolutionConfig config;
  config.max_generations = 1000;
  config.tolerance = 0.1;
  const BatchObjective raised = [](const RowMatrix& points) -> Vector {
    return sphere(points).array() + 1.0;
  };
  const auto result = differential_evolution(raised, 3, RowMatrix(), config);
  EXPECT_LT(result.num_evaluations, 128 * 100);
  EXPECT_LE(result.values(127) - result.values(0), 0.1 * result.values(0));
}

TEST(DifferentialEvolution, RestartsDrawOtherNumbers) {
  DifferentialEvolutionConfig config;
  config.max_generations = 1;
  const auto first = differential_evolution(sphere, 2, RowMatrix(), config);
  config.restart = 1;
  EXPECT_NE(differential_evolution(sphere, 2, RowMatrix(), config).points, first.points);
}

}  // namespace
}  // namespace npdr::analysis
