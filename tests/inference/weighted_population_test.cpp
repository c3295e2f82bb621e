#include "inference/weighted_population.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/constants.h"
#include "core/error.h"

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

TEST(Resampler, DrawsSystematicallyAsOftenAsWeightsSay) {
  const Resampler resampler(Vector{{1.0, 0.0, 2.5, 0.5}});
  EXPECT_EQ(resampler.systematic(4, 0.25), (std::vector<Index>{0, 2, 2, 2}));
  EXPECT_EQ(resampler.systematic(4, 0.75), (std::vector<Index>{0, 2, 2, 3}));
  EXPECT_EQ(resampler.systematic(2, 0.9), (std::vector<Index>{2, 3}));
}

TEST(Resampler, RejectsWeightsThatAreNone) {
  Vector weights(3);
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    weights << 0.2, bad, 0.3;
    EXPECT_THROW(Resampler{weights}, Error);
  }
  EXPECT_THROW(Resampler{Vector::Zero(3)}, Error);
}

TEST(ImportanceWeights, OfLogarithmsThatAreNone) {
  const Vector logs{{kNaN, 1.0, kInfinity, 2.0, -kInfinity}};
  EXPECT_EQ(largest_number(logs), 2.0);
  const Vector weights = exponentials(logs);
  EXPECT_EQ(weights(1), std::exp(-1.0));
  EXPECT_EQ(weights(3), 1.0);
  EXPECT_EQ(weights.sum(), 1.0 + std::exp(-1.0));
  EXPECT_TRUE(exponentials(Vector::Constant(2, kNaN)).isZero(0.0));
}

// One of 10,000 weights is all of them: it may be a hundredth.
TEST(ImportanceWeights, AreCutOffAtTheirMeanTimesTheRootOfHowMany) {
  Vector logs = Vector::Constant(10'000, -kInfinity);
  logs(7) = 3.0;
  EXPECT_DOUBLE_EQ(truncated(logs)(7), 0.01);
  EXPECT_EQ(truncated(logs).sum(), truncated(logs)(7));
}

TEST(ImportanceWeights, GiveTheEvidenceAndItsError) {
  const Evidence found = evidence(Vector{{std::log(1.0), std::log(3.0)}}.array() + 700.0);
  EXPECT_DOUBLE_EQ(found.log_value, 700.0 + std::log(2.0));
  EXPECT_NEAR(found.error, 0.5, 1e-12);  // of a mean of 2: the deviation is sqrt(2), over sqrt(2)
}

TEST(LargestPower, IsWhereEnoughEnds) {
  const auto up_to = [](double most) {
    return largest_power(0.0, 1.0, [&](double power) { return power <= most; });
  };
  EXPECT_NEAR(up_to(0.3), 0.3, 1e-12);
  EXPECT_EQ(up_to(2.0), 1.0);
  EXPECT_EQ(up_to(-1.0), 0.0) << "none is enough";
}

// Of 2000 draws of a third of the rows, the means are within five standard errors.
TEST(ChooseRows, KeepsWhatTheWeightsSayOnAverage) {
  const Vector weights{{0.1, 0.4, 0.5, 2.0, 0.0, 1.0}};
  constexpr int kTimes = 2000;
  Vector sum = Vector::Zero(weights.size());
  for (int i = 0; i < kTimes; ++i) {
    const Choice choice =
        choose_rows(weights, 2, {static_cast<std::uint64_t>(i), "choice", 0, 0, 0});
    ASSERT_GE(choice.weights.minCoeff(), 1.0);
    for (std::size_t k = 0; k < choice.rows.size(); ++k) {
      sum(choice.rows[k]) += choice.weights(static_cast<Index>(k));
    }
  }
  const Vector mean = sum / kTimes, wanted = weights / weights.sum() * mean.sum();
  for (Index i = 0; i < mean.size(); ++i) {
    EXPECT_NEAR(mean(i), wanted(i), 5.0 * std::sqrt(std::max(wanted(i), 1e-3) / kTimes)) << i;
  }
  EXPECT_EQ(mean(4), 0.0);
}

TEST(ChooseRows, KeepsAllThatWeighWhereMoreAreWanted) {
  EXPECT_EQ(choose_rows(Vector{{0.1, 0.0, 2.0}}, 10, {1, "choice", 0, 0, 0}).rows,
            (std::vector<Index>{0, 2}));
  EXPECT_TRUE(choose_rows(Vector::Zero(5), 2, {1, "choice", 0, 0, 0}).rows.empty());
}

// The second point is at 8 where 4 is the most, the third one where the density is 0.
TEST(HeavyShare, IsWhatLiesAboveTheMost) {
  const Vector weights{{1.0, 3.0, 0.5, 0.0}}, log_ratios{{0.0, std::log(8.0), kInfinity, kNaN}};
  EXPECT_DOUBLE_EQ(heavy_share(weights, log_ratios, std::log(4.0)), (1.5 + 0.5) / 4.5);
  EXPECT_EQ(heavy_share(weights.head(2), log_ratios.head(2), std::log(8.0)), 0.0);
}

TEST(HeavyShare, OfNothingIsNoNumber) {
  EXPECT_TRUE(std::isnan(heavy_share(Vector::Zero(2), Vector::Zero(2), 0.0)));
}

}  // namespace
}  // namespace npdr::inference
