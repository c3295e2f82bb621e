#include "analysis/differential_evolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace npdr::analysis {
namespace {

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
