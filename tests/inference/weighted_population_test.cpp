#include "inference/weighted_population.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"

namespace npdr::inference {
namespace {

// Weights 1, 3, 0 and, appended, 4.
WeightedPopulation four_points() {
  WeightedPopulation all(1);
  EXPECT_FALSE(all.has_weight());
  all.append({RowMatrix{{1.0}, {2.0}, {3.0}}, Vector{{0.0, std::log(3.0), kNaN}}});
  all.append({RowMatrix{{4.0}}, Vector{{std::log(4.0)}}});
  return all;
}

TEST(WeightedPopulation, WeighsItsPoints) {
  const WeightedPopulation all = four_points();
  EXPECT_TRUE(all.has_weight());
  EXPECT_TRUE(all.weights().isApprox(Vector{{0.25, 0.75, 0.0, 1.0}}, 1e-15));
  EXPECT_NEAR(all.effective_size(), 64.0 / 26.0, 1e-14);
  EXPECT_NEAR(all.log_mean_weight(), std::log(2.0), 1e-15);
  EXPECT_NEAR(all.mean()(0), 23.0 / 8.0, 1e-15);
  EXPECT_EQ(all.quantile(-all.points().col(0), 0.45), -4.0);
  EXPECT_EQ(all.quantile(-all.points().col(0), 0.55), -2.0);
  EXPECT_FALSE(WeightedPopulation(RowMatrix::Ones(1, 1), Vector{{-kInfinity}}).has_weight());
}

TEST(WeightedPopulation, IsDrawnFromInProportionToItsWeights) {
  const WeightedPopulation all = four_points();
  Stream stream({1, "resampling", 0, 0, 0});
  const RowMatrix eighths = all.resampled(8, stream);
  for (Index i = 0; i < 4; ++i) {
    EXPECT_EQ((eighths.array() == all.points()(i, 0)).count(), std::lround(4.0 * all.weights()(i)));
  }
  const StreamId id{2, "draws", 0, 0, 0};
  EXPECT_EQ(all.draw(3, id), all.draw(9, id).topRows(3));
}

TEST(WeightedPopulation, DrawsOfGroupsDependOnTheirRowAlone) {
  const auto draw_group = [](const StreamId& id) {
    return RowMatrix::Constant(4, 2, static_cast<double>(id.row));
  };
  const RowMatrix draws = draw_in_groups(6, 4, 2, {1, "draws", 0, 10, 0}, draw_group);
  EXPECT_EQ(draws.col(1), (Vector{{10.0, 10.0, 10.0, 10.0, 14.0, 14.0}}));
}

}  // namespace
}  // namespace npdr::inference
