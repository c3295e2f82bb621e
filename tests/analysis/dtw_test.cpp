#include "analysis/dtw.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.h"
#include "core/error.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

RowMatrix column(std::initializer_list<double> values) {
  RowMatrix series(static_cast<Index>(values.size()), 1);
  Index t = 0;
  for (const double v : values) series(t++, 0) = v;
  return series;
}

// A random walk (steps, channels): smooth enough for paths to leave the diagonal.
RowMatrix random_walk(std::uint64_t row, Index steps, Index channels) {
  Stream stream({1, "walk", 0, row, 0});
  RowMatrix walk(steps, channels);
  for (Index t = 0; t < steps; ++t) {
    for (Index c = 0; c < channels; ++c) {
      walk(t, c) = (t > 0 ? walk(t - 1, c) : 0.0) + 0.1 * stream.normal();
    }
  }
  return walk;
}

double distance(const RowMatrix& x, Index i, const RowMatrix& y, Index j) {
  double squares = 0.0;
  for (Index c = 0; c < x.cols(); ++c) squares += std::pow(x(i, c) - y(j, c), 2);
  return std::sqrt(squares);
}

// The recursion as it stands in the header, with the whole matrix D.
DtwResult naive_dtw(const RowMatrix& x, const RowMatrix& y, DtwEnd end) {
  RowMatrix cost(x.rows(), y.rows());
  for (Index i = 0; i < x.rows(); ++i) {
    for (Index j = 0; j < y.rows(); ++j) {
      const double d = distance(x, i, y, j);
      double best = i == 0 && j == 0 ? d : kInfinity;
      if (i > 0) best = std::min(best, cost(i - 1, j) + d);
      if (j > 0) best = std::min(best, cost(i, j - 1) + d);
      if (i > 0 && j > 0) best = std::min(best, cost(i - 1, j - 1) + 2.0 * d);
      cost(i, j) = best;
    }
  }
  DtwResult result{0.0, kInfinity, 0};
  for (Index j = end == DtwEnd::closed ? y.rows() - 1 : 0; j < y.rows(); ++j) {
    const double last = cost(x.rows() - 1, j);
    const double normalized = last / static_cast<double>(x.rows() + j + 1);
    if (normalized < result.normalized_distance) result = {last, normalized, j + 1};
  }
  return result;
}

// (num_series, m, C) from series of the same shape.
std::vector<double> stack(const std::vector<RowMatrix>& series) {
  std::vector<double> values;
  for (const RowMatrix& s : series) values.insert(values.end(), s.data(), s.data() + s.size());
  return values;
}

void expect_same_bits(const DtwResult& a, const DtwResult& b) {
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.normalized_distance, b.normalized_distance);
  EXPECT_EQ(a.end, b.end);
}

// One recorded state 1, simulated 2 2: D = 1 2, over n + m' = 2, 3 it is 1/2 and 2/3.
// Recorded 0, simulated 0 0 0: all ends cost 0, and the first is taken.
TEST(Dtw, TakesTheFirstOfSeveralEndsThatTie) {
  EXPECT_EQ(dtw(column({1}), column({2, 2})).end, 1);
  EXPECT_EQ(dtw(column({0}), column({0, 0, 0})).end, 1);
}

// Made with dtw-python 1.9.0 (Giorgino's own package), for i = 0, ..., 11 and j = 0, ..., 19:
//   x = np.stack([np.sin(i), np.cos(0.7 * i)], axis=1)
//   y = np.stack([np.sin(1.1 * j + 0.3), np.cos(0.6 * j)], axis=1)
//   r = dtw(x, y, step_pattern="symmetric2", open_end=True)   # or False
//   print(repr(r.distance), r.jmin + 1)
TEST(Dtw, AgreesWithTheReferenceImplementation) {
  RowMatrix x(12, 2), y(20, 2);
  for (Index i = 0; i < 12; ++i) {
    const auto t = static_cast<double>(i);
    x.row(i) << std::sin(t), std::cos(0.7 * t);
  }
  for (Index j = 0; j < 20; ++j) {
    const auto t = static_cast<double>(j);
    y.row(j) << std::sin(1.1 * t + 0.3), std::cos(0.6 * t);
  }
  EXPECT_NEAR(dtw(x, y).distance, 10.147456881090909, 1e-12);
  EXPECT_EQ(dtw(x, y).end, 10);
  EXPECT_NEAR(dtw(x, y, DtwEnd::closed).distance, 20.544177266976565, 1e-12);
}

TEST(Dtw, OfASeriesToItselfIsZero) {
  const RowMatrix walk = random_walk(0, 60, 4);
  expect_same_bits(dtw(walk, walk, DtwEnd::closed), {0.0, 0.0, 60});
}

TEST(Dtw, AgreesWithTheNaiveRecursionOnRandomSeries) {
  std::uint64_t row = 0;
  for (const Index n : {1, 2, 37, 80}) {
    for (const Index m : {1, 3, 37, 120}) {
      for (const Index channels : {1, 2, 4, 9, 16, 17}) {
        const RowMatrix x = random_walk(row++, n, channels);
        const RowMatrix y = random_walk(row++, m, channels);
        for (const DtwEnd end : {DtwEnd::open, DtwEnd::closed}) {
          const DtwResult result = dtw(x, y, end);
          const DtwResult expected = naive_dtw(x, y, end);
          EXPECT_EQ(result.end, expected.end) << n << " " << m << " " << channels;
          EXPECT_NEAR(result.distance, expected.distance, 1e-12 * (1.0 + expected.distance));
          EXPECT_NEAR(result.normalized_distance, expected.normalized_distance, 1e-12);
        }
      }
    }
  }
}

TEST(Dtw, BatchHasTheBitsOfTheScalarForm) {
  for (const Index channels : {1, 2, 3, 4, 9, 17}) {
    const RowMatrix recorded = random_walk(1000, 50, channels);
    for (const Index m : {30, 50, 70}) {  // the scalar form turns the column for m < n
      std::vector<RowMatrix> series;
      for (std::uint64_t k = 0; k < 19; ++k) series.push_back(random_walk(k, m, channels));
      for (const DtwEnd end : {DtwEnd::open, DtwEnd::closed}) {
        const auto batch = dtw_batch(recorded, stack(series), 19, end);
        for (std::size_t k = 0; k < series.size(); ++k) {
          expect_same_bits(batch[k], dtw(recorded, series[k], end));
        }
      }
    }
  }
}

TEST(Dtw, AValueThatIsNotFiniteGivesNanAndLeavesTheOtherLanesAlone) {
  const RowMatrix recorded = random_walk(7, 20, 2);
  std::vector<RowMatrix> series = {random_walk(8, 20, 2), random_walk(9, 20, 2)};
  const DtwResult clean = dtw(recorded, series[1]);
  series[0](19, 1) = kNaN;
  EXPECT_TRUE(std::isnan(dtw(recorded, series[0]).distance));
  EXPECT_TRUE(std::isnan(dtw(series[0], recorded).distance));
  const auto batch = dtw_batch(recorded, stack(series), 2);
  EXPECT_TRUE(std::isnan(batch[0].distance));
  EXPECT_TRUE(std::isnan(batch[0].normalized_distance));
  EXPECT_EQ(batch[0].end, 0);
  expect_same_bits(batch[1], clean);
  const auto unusable = dtw_batch(series[0], stack(series), 2);
  EXPECT_TRUE(std::isnan(unusable[1].distance));
}

TEST(Dtw, RejectsEmptySeriesAndOtherChannelCounts) {
  EXPECT_THROW(dtw(RowMatrix(0, 1), column({1})), ShapeError);
  EXPECT_THROW(dtw(column({1}), RowMatrix(0, 1)), ShapeError);
  EXPECT_THROW(dtw(column({1}), RowMatrix::Zero(3, 2)), ShapeError);
  const std::vector<double> values(5);
  EXPECT_THROW(dtw_batch(column({1}), values, 2), ShapeError);
  EXPECT_THROW(dtw_batch(column({1}), {}, 2), ShapeError);
  EXPECT_THROW(dtw_batch(column({1}), values, -5), ShapeError);
  EXPECT_TRUE(dtw_batch(column({1}), {}, 0).empty());
}

}  // namespace
}  // namespace npdr::analysis
