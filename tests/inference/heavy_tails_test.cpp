#include "inference/heavy_tails.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "inference/feature_transform.h"
#include "inference/matrix_features.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

template <class Map>
std::vector<float> values_of(Index count, const Map& map) {
  const RowMatrix z = random_matrix(count, 1, 1);
  std::vector<float> values;
  for (Index i = 0; i < count; ++i) values.push_back(static_cast<float>(map(z(i, 0))));
  return values;
}

double uniform(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

TEST(HeavyTails, AreOfWhatSpansOrdersOfMagnitude) {
  EXPECT_TRUE(compression_of(values_of(2000, [](double z) { return std::exp(z); })));
  EXPECT_TRUE(compression_of(values_of(2000, [](double z) { return -5.0 * std::exp(3.0 * z); })));
  EXPECT_TRUE(compression_of(values_of(2000, [](double z) { return std::sinh(3.0 * z) + 1e3; })));
}

// The scale is the smallest of the numbers that follow each other closely: a count of 1, not 0.
TEST(HeavyTails, ZerosAndStraySignsLeaveTheLogarithm) {
  const auto counts =
      values_of(2000, [](double z) { return std::floor(std::pow(10.0, -1.0 + 5.0 * uniform(z))); });
  const auto of_counts = compression_of(counts);
  ASSERT_TRUE(of_counts);
  EXPECT_EQ(of_counts->center, 0.0f);
  EXPECT_EQ(of_counts->scale, 1.0f);
  auto decades = values_of(2000, [](double z) { return std::pow(10.0, 10.0 * uniform(z) - 10.0); });
  const auto whole = compression_of(decades);
  ASSERT_TRUE(whole);
  decades.front() = 0.0f;
  decades.back() = -1e-9f;
  decades[7] = 1e-32f;
  const auto with_strays = compression_of(decades);
  ASSERT_TRUE(with_strays);
  for (const auto& found : {*whole, *with_strays}) EXPECT_LT(found.scale, 1e-9f);
}

// Residues of solvers among many zeros.
TEST(HeavyTails, StraysAmongZerosAreNoScale) {
  for (const double share : {0.1, 0.5}) {
    auto values = values_of(2000, [&](double z) {
      return std::sin(99.0 * z) > 1.0 - 2.0 * share ? 0.0 : std::exp(2.0 * z);
    });
    const auto clean = compression_of(values);
    values[3] = 1e-28f;
    const auto found = compression_of(values);
    ASSERT_TRUE(clean && found);
    EXPECT_GT(found->scale, 0.5f * clean->scale);
    EXPECT_GT(found->scale, 1e-3f);
  }
  EXPECT_FALSE(compression_of(values_of(2000, [](double z) { return std::max(0.0, z); })));
}

// Nearly all are a few counts, one of thirty is a catastrophe of any size.
TEST(HeavyTails, AreOfARareRegime) {
  const auto values = values_of(2000, [](double z) {
    return uniform(z) > 0.97 ? std::pow(10.0, 4.0 + 66.0 * (uniform(z) - 0.97))
                             : std::round(std::abs(2.0 * std::sin(99.0 * z)));
  });
  const auto found = compression_of(values);
  ASSERT_TRUE(found);
  EXPECT_LT(found->scale, 10.0f);
}

TEST(HeavyTails, ArentOfAFewOutliers) {
  auto values = values_of(2000, [](double z) { return z; });
  values[3] = 1e30f;
  values[4] = -1e20f;
  EXPECT_FALSE(compression_of(values));
}

TEST(HeavyTails, ArentOfWhatHasAScale) {
  EXPECT_FALSE(compression_of(values_of(2000, [](double z) { return z; })));
  EXPECT_FALSE(compression_of(values_of(2000, [](double z) { return uniform(z); })));
  EXPECT_FALSE(compression_of(values_of(2000, [](double z) { return std::exp(0.4 * z); })));
  for (const double width : {0.0, 0.01, 0.05}) {  // of two modes
    EXPECT_FALSE(compression_of(values_of(2000, [&](double z) {
      return (z > 0.8 ? 1.0 : -1.0) + width * std::sin(99 * z);
    }))) << width;
  }
  EXPECT_FALSE(compression_of(values_of(2000, [](double z) {  // counts, half of them zero
    return z > 0.0 ? std::round(1000.0 * uniform(z)) : 0.0;
  })));
  EXPECT_FALSE(compression_of(values_of(99, [](double z) { return std::exp(5.0 * z); })));
  EXPECT_FALSE(compression_of(std::vector<float>(2000, 3.0f)));
  EXPECT_FALSE(compression_of({}));
}

// Of numbers at the ends of single precision t is still one.
TEST(HeavyTails, AreNoneWhereTheyCantBeHeld) {
  const auto wide = values_of(2000, [](double z) { return 1e-34 * std::exp(25.0 * z); });
  if (const auto found = compression_of(wide)) {
    EXPECT_TRUE(std::isfinite(1.0f / found->scale));
    EXPECT_TRUE(std::isfinite(std::asinh((wide.front() - found->center) * (1.0f / found->scale))));
  }
  EXPECT_FALSE(compression_of(values_of(2000, [](double z) { return 1e-36 * std::exp(z); })));
}

TEST(HeavyTails, TheUnitDoesNotMatter) {
  const std::vector<float> values = values_of(2000, [](double z) { return std::exp(2.0 * z); });
  const auto found = compression_of(values);
  ASSERT_TRUE(found);
  std::vector<float> larger = values;
  for (float& value : larger) value *= 1024.0f;
  const auto found_larger = compression_of(larger);
  ASSERT_TRUE(found_larger);
  EXPECT_EQ(found_larger->center, 1024.0f * found->center);
  EXPECT_EQ(found_larger->scale, 1024.0f * found->scale);
}

// Of three features the second spans orders of magnitude.
RowMatrixF one_of_three() {
  RowMatrixF x = random_matrix(2000, 3, 1).cast<float>();
  x.col(1) = (3.0f * x.col(1).array()).exp();
  return x;
}

TEST(HeavyTails, ATransformCompressesThoseFeaturesAlone) {
  const RowMatrixF x = one_of_three();
  const MatrixFeatures source(x);
  const FeatureTransform kept = fit_feature_transform(source, 0);
  const FeatureTransform compressed = fit_feature_transform(source, 0, Tails::compressed);
  EXPECT_EQ(kept.center.size(), 0);
  RowMatrixF before, z;
  kept.apply(x, before);
  compressed.apply(x, z);
  EXPECT_EQ(z.col(0), before.col(0));
  EXPECT_EQ(z.col(2), before.col(2));
  EXPECT_NEAR(z.col(1).mean(), 0.0, 1e-3);  // a few ended at what is usual
  EXPECT_NEAR(z.col(1).squaredNorm() / 2000.0, 1.0, 1e-2);
  // The middle half is 1.35 deviations wide, as of a normal variable; 0.1 before.
  const auto width = [](const RowMatrixF& of) {
    std::vector<float> values(of.col(1).begin(), of.col(1).end());
    std::ranges::sort(values);
    return values[1500] - values[500];
  };
  EXPECT_NEAR(width(z), 1.35, 0.2);
  EXPECT_LT(width(before), 0.2);
  const FeatureTransform plain =
      fit_feature_transform(MatrixFeatures(x.leftCols(1)), 0, Tails::compressed);
  EXPECT_EQ(plain.center.size(), 0);
}

TEST(HeavyTails, ATransformMayShowThoseFeaturesTwice) {
  const RowMatrixF x = one_of_three();
  const MatrixFeatures source(x);
  const FeatureTransform both = fit_feature_transform(source, 0, Tails::both);
  EXPECT_EQ(both.num_inputs(), 3);
  EXPECT_EQ(both.num_copies(), 1);
  EXPECT_EQ(both.num_outputs(), 4);
  RowMatrixF kept, compressed, z, once;
  fit_feature_transform(source, 0).apply(x, kept);
  fit_feature_transform(source, 0, Tails::compressed).apply(x, compressed);
  both.apply(x, z);
  EXPECT_EQ(z.leftCols(3), compressed);
  EXPECT_EQ(z.col(3), kept.col(1));
  without_copies(both).apply(x, once);
  EXPECT_EQ(once, compressed);
  const FeatureTransform none =
      fit_feature_transform(MatrixFeatures(x.leftCols(1)), 0, Tails::both);
  EXPECT_EQ(none.num_copies(), 0);
}

}  // namespace
}  // namespace npdr::inference
