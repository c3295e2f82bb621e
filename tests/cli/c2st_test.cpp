/// `npdr compare` says what scikit-learn says.
#include <nlohmann/json.hpp>

#include "core/random.h"
#include "tests/cli/program.h"

namespace npdr::pipeline {
namespace {

// Rows of N(mean, deviation^2) in two dimensions, the second one correlated with the square of the
// first: what a linear classifier can't tell apart.
void write_rows(const std::filesystem::path& path, double mean, double deviation, double bend,
                std::uint64_t seed) {
  std::ofstream file(path);
  file << "a,b\n";
  Stream stream({seed, "rows", 0, 0, 0});
  for (int i = 0; i < 1000; ++i) {
    const double a = mean + deviation * stream.normal();
    file << a << ',' << stream.normal() + bend * a * a << '\n';
  }
}

class ScikitLearn : public ::testing::Test {
 protected:
  // The accuracies of both.
  void expect_same(double mean, double deviation, double bend) const {
    write_rows(folder_ / "one.csv", 0.0, 1.0, 0.0, 1);
    write_rows(folder_ / "two.csv", mean, deviation, bend, 2);
    const Outcome ours = run(
        folder_.path(), {NPDR_BINARY_DIR "/bin/npdr", "compare", "one.csv", "two.csv", "--json"});
    ASSERT_EQ(ours.status, 0) << ours.err;
    const Outcome theirs =
        run(folder_.path(),
            {python_, NPDR_SOURCE_DIR "/tests/cli/c2st_of_scikit.py", "one.csv", "two.csv"});
    ASSERT_EQ(theirs.status, 0) << theirs.err;
    const double accuracy = nlohmann::json::parse(ours.out)["c2st"]["accuracy"];
    std::cout << accuracy << ", by scikit-learn " << theirs.out;
    // Both see the same rows: they differ by folds and training, whose deviation is about that of
    // 2000 rows, 0.011. Three of these, fixed seeds.
    EXPECT_NEAR(accuracy, std::stod(theirs.out), 0.035);
  }

  const std::string python_ = python_with("sklearn");
  TempFolder folder_;
};

TEST_F(ScikitLearn, SaysHowFarApartSamplesAreAsCompareDoes) {
  if (python_.empty()) GTEST_SKIP() << "needs scikit-learn";
  expect_same(0.0, 1.0, 0.0);
  expect_same(0.5, 1.0, 0.0);
  expect_same(0.0, 1.0, 0.5);
  expect_same(0.0, 3.0, 0.0);
}

}  // namespace
}  // namespace npdr::pipeline
