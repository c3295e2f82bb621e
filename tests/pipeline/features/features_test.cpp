
#include "core/constants.h"
#include "pipeline/features/observation.h"
#include "pipeline/features/simulation_features.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {
namespace {

// Few rows stay in memory, many go to a file: both must give back what was written.
TEST(RowStore, GivesBackWhatWasWrittenInMemoryAndInAFile) {
  const TempFolder folder;
  for (const Index width : {Index{4}, Index{2} << 20}) {  // 320 B, and 640 MiB that aren't filled
    RowStore store(80, width, folder.path());
    std::vector<float> row(static_cast<std::size_t>(width));
    for (const Index i : {Index{79}, Index{0}, Index{41}}) {
      row.front() = static_cast<float>(i);
      row.back() = static_cast<float>(-i);
      store.write(i, row);
    }
    for (const Index i : {Index{0}, Index{41}, Index{79}}) {
      store.read(i, row);
      EXPECT_EQ(row.front(), static_cast<float>(i));
      EXPECT_EQ(row.back(), static_cast<float>(-i));
    }
  }
  EXPECT_EQ(folder.size(), 0);  // the file has no name
}

// One rollout of two states of two picked channels out of three.
inference::SeriesSelection selection() { return {1, 2, 3, 1, {0, 2}}; }

TEST(SeriesSummary, HoldsFiveNumbersOfEachPickedChannel) {
  const std::vector<float> picked = {1.0f, -4.0f, 3.0f, -6.0f};
  EXPECT_EQ(summarize(picked, selection()),
            (Vector{{2.0, 1.0, 1.0, 3.0, 3.0, -5.0, 1.0, -6.0, -4.0, -6.0}}));
  const auto names = summary_names(selection(), {{"x", "m"}, {"y", "m"}, {"z", "m"}});
  ASSERT_EQ(names.size(), 10u);
  EXPECT_EQ(names.front(), "rollout 1, x: mean");
  EXPECT_EQ(names.back(), "rollout 1, z: last");
}

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

TEST(UsualFeatures, AreOfSomeFiniteRowsOrNone) {
  EXPECT_EQ(num_seen({300, 0}, 1000), 300);
  EXPECT_EQ(num_seen({300, 0}, 100), 100);
  EXPECT_EQ(num_seen({300, 50}, 1000), 250);
  EXPECT_EQ(num_seen({39, 0}, 1000), 0) << "too few";
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
