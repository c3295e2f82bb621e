#include "inference/algorithms/atomic_loss.h"

#include <gtest/gtest.h>

#include <set>

#include "core/error.h"
#include "tests/inference/gradient_check.h"

namespace npdr::inference {
namespace {

TEST(AtomicLoss, AtomsAreDistinctAndBeginWithTheRowItself) {
  Stream stream({1, "atoms", 0, 0, 0});
  const auto atoms = draw_atoms(12, 5, stream);
  ASSERT_EQ(atoms.size(), 60u);
  for (std::uint32_t i = 0; i < 12; ++i) {
    EXPECT_EQ(atoms[i * 5], i);
    EXPECT_EQ(std::set<std::uint32_t>(&atoms[i * 5], &atoms[i * 5] + 5).size(), 5u);
  }
}

TEST(AtomicLoss, EveryOtherRowIsDrawnEquallyOften) {
  Stream stream({1, "atoms", 0, 0, 0});
  std::vector<int> counts(10, 0);
  constexpr int repeats = 5000;
  for (int r = 0; r < repeats; ++r) {
    const auto atoms = draw_atoms(10, 4, stream);
    for (std::size_t a = 1; a < 4; ++a) ++counts[atoms[a]];  // the atoms of row 0
  }
  EXPECT_EQ(counts[0], 0);
  const double expected = repeats * 3.0 / 9.0;
  double chi_square = 0.0;
  for (std::size_t i = 1; i < 10; ++i) {
    chi_square += (counts[i] - expected) * (counts[i] - expected) / expected;
  }
  EXPECT_LT(chi_square, 31.8);  // chi-square with 8 degrees of freedom: false-alarm rate 1e-4
}

TEST(AtomicLoss, RejectsMoreAtomsThanRows) {
  Stream stream({1, "atoms", 0, 0, 0});
  EXPECT_THROW(draw_atoms(3, 4, stream), ShapeError);
}

TEST(AtomicLoss, IsLogKWhenNothingIsKnown) {
  Vector d;
  EXPECT_NEAR(atomic_loss<double>(Vector::Zero(20), Vector::Zero(20), 5, d), std::log(5.0), 1e-12);
}

TEST(AtomicLoss, GradientEqualsCentralDifferences) {
  const Vector log_prob = random_matrix(12, 1, 1).col(0);
  const Vector log_prior = random_matrix(12, 1, 2).col(0);
  Vector gradient, unused;
  atomic_loss<double>(log_prob, log_prior, 4, gradient);
  expect_gradient([&](const Vector& p) { return atomic_loss<double>(p, log_prior, 4, unused); },
                  log_prob, gradient);
}

}  // namespace
}  // namespace npdr::inference
