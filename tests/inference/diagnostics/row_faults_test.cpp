#include "inference/diagnostics/row_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/constants.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

constexpr Index kRows = 1000;

// x = (a + b, a b) of standard normal theta, with noise.
class RowFaults : public testing::Test {
 protected:
  RowFaults() : theta_(kRows, 2), x_(kRows, 2) {
    for (double& value : theta_.reshaped()) value = stream_.normal();
    simulate(0.2);
  }

  void simulate(double noise) {
    for (Index i = 0; i < kRows; ++i) {
      const double a = theta_(i, 0), b = theta_(i, 1);
      x_.row(i) << static_cast<float>(a + b + noise * stream_.normal()),
          static_cast<float>(a * b + noise * stream_.normal());
    }
  }

  // Each theta `times` times, one after the other.
  void repeat_theta(Index times) {
    for (Index i = 0; i < kRows; ++i) theta_.row(i) = theta_.row(i / times * times);
  }

  void map_x(const std::function<double(double)>& map) {
    for (float& value : x_.reshaped()) value = static_cast<float>(map(double{value}));
  }

  bool are_found() const {
    const RowCopies copies = find_copies(theta_, x_);
    return find_stretch(theta_, x_) || count_same_rows(theta_, x_) > 0 || copies.num_exact > 0 ||
           copies.num_near > 0 || !find_codes(x_).empty();
  }

  Stream stream_{{1, "test", 0, 0, 0}};
  RowMatrix theta_;
  RowMatrixF x_;
};

TEST_F(RowFaults, AreNoneOfWhatSimulatorsGive) {
  EXPECT_FALSE(are_found());
  const RowMatrixF drawn = x_;
  const auto expect_none = [&](const char* what, const std::function<double(double)>& map) {
    x_ = drawn;
    map_x(map);
    EXPECT_FALSE(are_found()) << what;
  };
  expect_none("rectified", [](double v) { return std::max(v, 0.0); });
  expect_none("log-normal", [](double v) { return std::exp(5.0 * v); });
  expect_none("counts", [](double v) { return std::round(3.0 * std::exp(v)); });
  expect_none("rare counts", [](double v) { return std::round(0.1 * std::exp(v)); });
  expect_none("heavy tails", [&](double v) { return v + stream_.normal() / stream_.normal(); });
  expect_none("ticks", [](double v) { return std::round(v / 0.0048828125) * 0.0048828125; });
  x_ = drawn;
  for (Index i = 0; i < kRows; i += 7) x_(i, 0) = kFloatNaN;
  EXPECT_FALSE(are_found()) << "failed rows";
}

TEST_F(RowFaults, AreNoneOfReplicatesAndOfThetaInAnOrder) {
  repeat_theta(5);
  simulate(0.2);
  EXPECT_FALSE(are_found()) << "replicates";
  std::sort(theta_.data(), theta_.data() + theta_.size());
  simulate(0.0);
  EXPECT_FALSE(find_stretch(theta_, x_)) << "sorted";
}

TEST_F(RowFaults, AreStretchesInAnotherOrderUnitOrVersion) {
  const RowMatrixF right = x_;
  for (Index i = 0; i < 30; ++i) x_.row(kRows - 30 + i) = right.row(kRows - 1 - i);
  auto found = find_stretch(theta_, x_);
  ASSERT_TRUE(found);
  EXPECT_NEAR(static_cast<double>(found->begin), 970.0, 15.0);
  EXPECT_GT(found->mean_rank, 0.75);
  x_ = right;
  x_.middleRows(400, 100) *= 10.0f;
  found = find_stretch(theta_, x_);
  ASSERT_TRUE(found);
  EXPECT_NEAR(static_cast<double>(found->begin), 400.0, 30.0);
  EXPECT_NEAR(static_cast<double>(found->count), 100.0, 40.0);
  x_ = right;
  x_.bottomRows(200).array() += 0.3f;
  EXPECT_TRUE(find_stretch(theta_, x_));
}

TEST_F(RowFaults, AreRowsOfOtherThetaThatAreTheSame) {
  for (Index i = 0; i < 15; ++i) x_.row(40 * i + 3) = x_.row(40 * i + 20);
  EXPECT_EQ(count_same_rows(theta_, x_), 30);
  map_x([](double v) { return std::max(v, 0.0); });
  EXPECT_GT(count_same_rows(theta_, x_), 0) << "among rectified ones";
  for (Index i = 0; i < 15; ++i) theta_(40 * i + 3, 0) = theta_(40 * i + 20, 0);
  EXPECT_EQ(count_same_rows(theta_, x_), 0) << "x may depend on one parameter alone";
}

TEST_F(RowFaults, AreCopiesExactAndNear) {
  for (const double jitter : {0.0, 1e-7}) {
    for (Index i = 0; i < 15; ++i) {
      theta_.row(40 * i + 3) = theta_.row(40 * i + 20).array() + jitter;
      x_.row(40 * i + 3) = x_.row(40 * i + 20).array() + static_cast<float>(jitter);
    }
    const RowCopies found = find_copies(theta_, x_);
    EXPECT_EQ(found.num_exact, jitter > 0.0 ? 0 : 15);
    EXPECT_EQ(found.num_near, jitter > 0.0 ? 15 : 0);
  }
}

TEST_F(RowFaults, AreNoCopiesWhereOneParameterVariesBesideAConstant) {
  theta_.col(1).setConstant(0.5);
  simulate(0.0);
  EXPECT_EQ(find_copies(theta_, x_).num_near, 0);
}

TEST_F(RowFaults, AreExactCopiesAmongReplicates) {
  repeat_theta(4);
  simulate(0.2);
  for (Index i = 0; i < kRows; i += 100) x_.row(i + 1) = x_.row(i);
  EXPECT_EQ(find_copies(theta_, x_).num_exact, 10);
}

TEST_F(RowFaults, AreCodesExactAndWithAJitter) {
  x_(3, 1) = x_(40, 1) = x_(41, 1) = -999.0f;
  auto found = find_codes(x_);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].column, 1);
  EXPECT_EQ(found[0].value, -999.0f);
  EXPECT_EQ(found[0].count, 3);
  EXPECT_TRUE(found[0].is_exact);
  for (Index i = 0; i < kRows; i += 9) x_(i, 0) = 1e5f + 0.001f * static_cast<float>(i);
  found = find_codes(x_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].count, 112);
  x_(3, 1) = 50.0f;
  EXPECT_EQ(find_codes(x_.rightCols(1).topRows(20)).size(), 0u) << "a heavy tail";
}

TEST_F(RowFaults, AreNoCodesOfAnotherMode) {
  for (Index i = 0; i < kRows; i += 3) x_.row(i).array() += 1000.0f;
  EXPECT_TRUE(find_codes(x_).empty());
}

}  // namespace
}  // namespace npdr::inference
