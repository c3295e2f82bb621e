#include "pipeline/features/simulation_features.h"

#include <gtest/gtest.h>

#include "core/constants.h"

namespace npdr::pipeline {
namespace {

// Rows (n, 2) of which the last `num_lost` have overflowed.
class Rows : public inference::FeatureSource {
 public:
  Rows(Index n, Index num_lost) : x_(n, 2) {
    Stream stream({1, "features", 0, 0, 0});
    for (float& value : x_.reshaped()) value = static_cast<float>(stream.normal());
    x_.bottomRows(num_lost).col(1).setConstant(kFloatNaN);
  }
  Index num_rows() const override { return x_.rows(); }
  Index num_features() const override { return x_.cols(); }
  void gather(std::span<const std::uint32_t> rows, std::uint64_t /*epoch*/,
              RowMatrixF& x) const override {
    x = x_(std::vector<Index>(rows.begin(), rows.end()), Eigen::all);
  }

 private:
  RowMatrixF x_;
};

Index num_seen(const Rows& rows, Index most_rows) {
  const auto usual =
      usual_features_of(rows, inference::Tails::kept, most_rows, {1, "usual", 0, 0, 0});
  return usual ? usual->known.rows() + usual->distances.rows() : 0;
}

TEST(UsualFeatures, AreOfSomeFiniteRows) {
  EXPECT_EQ(num_seen({300, 0}, 1000), 300);
  EXPECT_EQ(num_seen({300, 0}, 100), 100);
  EXPECT_EQ(num_seen({300, 50}, 1000), 250);
}

TEST(UsualFeatures, OfTooFewRowsAreNone) {
  EXPECT_EQ(num_seen({39, 0}, 1000), 0);
  EXPECT_EQ(num_seen({40, 0}, 1000), 40);
  EXPECT_EQ(num_seen({300, 261}, 1000), 0);
}

TEST(UsualFeatures, AreThoseOfTheRowsThatTheStreamPicks) {
  const Rows rows(300, 0);
  const auto of = [&](const char* name) {
    return usual_features_of(rows, inference::Tails::kept, 100, {1, name, 0, 0, 0})->known;
  };
  EXPECT_EQ(of("usual"), of("usual"));
  EXPECT_NE(of("usual"), of("other"));
}

}  // namespace
}  // namespace npdr::pipeline
