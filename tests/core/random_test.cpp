#include "core/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/normal.h"

namespace npdr {
namespace {

StreamId stream_id(std::uint64_t row = 0) { return {1, "test", 0, row, 0}; }

TEST(Random, SameIdentityGivesTheSameBits) {
  Stream a(stream_id());
  Stream b(stream_id());
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(a.bits(), b.bits());
}

TEST(Random, EveryPartOfTheIdentityMatters) {
  std::set<std::uint32_t> firsts;
  for (const StreamId& id :
       {StreamId{1, "test", 0, 0, 0}, StreamId{2, "test", 0, 0, 0}, StreamId{1, "tess", 0, 0, 0},
        StreamId{1, "test", 1, 0, 0}, StreamId{1, "test", 0, 1, 0}, StreamId{1, "test", 0, 0, 1},
        StreamId{1, "test", 0, std::uint64_t{1} << 40, 0}}) {
    firsts.insert(Stream(id).bits());
  }
  EXPECT_EQ(firsts.size(), 7u);
}

TEST(Random, UniformHasTheRightMeanAndVariance) {
  constexpr int n = 200'000;
  Stream stream(stream_id());
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < n; ++i) {
    const double v = stream.uniform();
    ASSERT_GT(v, 0.0);
    ASSERT_LT(v, 1.0);
    sum += v;
    squares += v * v;
  }
  // Five standard errors: false-alarm rate 6e-7, and the seed is fixed.
  EXPECT_NEAR(sum / n, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(squares / n, 1.0 / 3.0, 5.0 * std::sqrt(4.0 / 45.0 / n));
}

// Kolmogorov-Smirnov distance of a sample to the standard normal.
double kolmogorov_distance(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double p = normal_cdf(values[i]);
    distance =
        std::max({distance, p - static_cast<double>(i) / n, static_cast<double>(i + 1) / n - p});
  }
  return distance;
}

TEST(Random, NormalsFollowTheNormalDistribution) {
  constexpr std::size_t n = 100'000;
  Stream stream(stream_id());
  std::vector<double> scalar(n);
  for (double& v : scalar) v = stream.normal();
  std::vector<float> bulk(n);
  Stream(stream_id(7)).fill_normal(bulk);
  // P(sqrt(n) D > 2.3) = 2 exp(-2 * 2.3^2) = 5e-5; the seed is fixed.
  const double bound = 2.3 / std::sqrt(static_cast<double>(n));
  EXPECT_LT(kolmogorov_distance(scalar), bound);
  EXPECT_LT(kolmogorov_distance({bulk.begin(), bulk.end()}), bound);
}

TEST(Random, BulkNormalsAreUncorrelatedNeighbors) {
  constexpr std::size_t n = 100'000;
  std::vector<float> bulk(n);
  Stream(stream_id(3)).fill_normal(bulk);
  for (const std::size_t lag : {1u, 2u, 32u, 64u}) {
    double product = 0.0;
    for (std::size_t i = 0; i + lag < n; ++i) product += double{bulk[i]} * double{bulk[i + lag]};
    EXPECT_LT(std::abs(product / n), 5.0 / std::sqrt(static_cast<double>(n))) << lag;
  }
}

TEST(Random, BulkNormalsOfAPrefixAreAPrefix) {
  std::vector<float> shorter(70), longer(200);
  Stream(stream_id()).fill_normal(shorter);
  Stream(stream_id()).fill_normal(longer);
  EXPECT_TRUE(std::equal(shorter.begin(), shorter.end(), longer.begin()));
}

TEST(Random, BulkNormalsAreOfTheWordsThatFollow) {
  constexpr std::size_t chunk = kPhiloxWords, n = 3 * chunk;
  std::vector<float> fresh(n);
  Stream(stream_id()).fill_normal(fresh);
  for (std::size_t used = 1; used < 4; ++used) {
    Stream stream(stream_id()), words(stream_id());
    for (std::size_t i = 0; i < used; ++i) stream.bits();
    std::vector<float> later(n);
    stream.fill_normal(later);
    for (std::size_t i = 0; i < n + used; ++i) words.bits();
    EXPECT_EQ(stream.bits(), words.bits());
    // Normals i and i + chunk / 2 of a chunk are of its words i and i + chunk / 2.
    for (std::size_t half = 0; half < n; half += chunk / 2) {
      EXPECT_TRUE(std::equal(fresh.begin() + half + used, fresh.begin() + half + chunk / 2,
                             later.begin() + half));
    }
  }
}

TEST(Random, BelowIsUniform) {
  constexpr std::uint32_t sides = 6;
  constexpr int n = 60'000;
  std::array<int, sides> counts{};
  Stream stream(stream_id());
  for (int i = 0; i < n; ++i) ++counts.at(stream.below(sides));
  double chi_square = 0.0;
  for (const int c : counts) chi_square += std::pow(c - n / 6.0, 2) / (n / 6.0);
  EXPECT_LT(chi_square, 25.7);  // chi-square with 5 degrees of freedom: false-alarm rate 1e-4
}

TEST(Random, PermutationHoldsEveryIndexOnce) {
  const auto order = Stream(stream_id()).permutation(1000);
  EXPECT_EQ(std::set<std::uint32_t>(order.begin(), order.end()).size(), 1000u);
  EXPECT_EQ(*std::max_element(order.begin(), order.end()), 999u);
  EXPECT_FALSE(std::is_sorted(order.begin(), order.end()));
}

}  // namespace
}  // namespace npdr
