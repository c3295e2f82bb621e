#include "pipeline/sources/first_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/error.h"
#include "tests/message_of.h"

namespace npdr::pipeline {
namespace {

// One feature a row, from a call's rows of theta and their seeds.
using Call = std::function<std::vector<double>(const RowMatrix& theta,
                                               std::span<const std::uint32_t> seeds)>;

class Simulator final : public RowSimulator {
 public:
  explicit Simulator(Call call) : call_(std::move(call)) {}

  sim::Trajectories simulate(const RowMatrix& theta, const StreamId& first) override {
    std::vector<std::uint32_t> seeds;
    for (Index i = 0; i < theta.rows(); ++i) seeds.push_back(row_seed(first, i));
    sim::Trajectories result;
    result.resize(theta.rows(), 1, 1, 1);
    std::ranges::copy(call_(theta, seeds), result.values.begin());
    return result;
  }
  Index block_size(Index num_rows) const override { return num_rows; }

 private:
  Call call_;
};

constexpr StreamId kFirst{1, kSimulationStream, 1, 0, 0};

std::vector<std::string> check(Call call, bool has_noise = false, Index num_rows = 40) {
  Simulator simulator(std::move(call));
  RowMatrix theta(num_rows, 1);
  for (Index i = 0; i < num_rows; ++i) theta(i, 0) = std::fmod(0.7 * static_cast<double>(i), 1.0);
  const sim::Trajectories rows = simulator.simulate(theta, kFirst);
  return texts_of(check_rows(simulator, {theta, rows, kFirst}, has_noise));
}

double noise(std::uint32_t seed) { return Stream({seed, "noise", 0, 0, 0}).normal(); }

std::vector<double> sound(const RowMatrix& theta, std::span<const std::uint32_t> seeds) {
  std::vector<double> x;
  for (Index i = 0; i < theta.rows(); ++i) {
    x.push_back(theta(i, 0) + 0.1 * noise(seeds[static_cast<std::size_t>(i)]));
  }
  return x;
}

void expect_one(const std::vector<std::string>& warnings, const std::string& part) {
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_TRUE(has(warnings[0], part));
}

// Half of the rows are 0: whose they are can't be told.
TEST(RowCheck, RowsInAnotherOrderAreRefusedWhereManyAreTheSame) {
  const auto clipped = [](const RowMatrix& theta, std::span<const std::uint32_t> seeds) {
    std::vector<double> x = sound(theta, seeds);
    for (double& value : x) value = std::max(value - 0.5, 0.0);
    return x;
  };
  const auto reversed = [&](const RowMatrix& theta, std::span<const std::uint32_t> seeds) {
    std::vector<double> x = clipped(theta, seeds);
    std::ranges::reverse(x);
    return x;
  };
  EXPECT_TRUE(check(clipped).empty());
  const std::string message = message_of<InputError>([&] { check(reversed); });
  EXPECT_TRUE(has(message, "in another order"));
}

TEST(RowCheck, NoiseThatRowsOfACallShareIsTold) {
  const auto shared = [](const RowMatrix& theta, std::span<const std::uint32_t> seeds) {
    std::vector<double> x;
    for (Index i = 0; i < theta.rows(); ++i) x.push_back(theta(i, 0) + 0.1 * noise(seeds[0]));
    return x;
  };
  const std::vector<std::string> warnings = check(shared);
  ASSERT_EQ(warnings.size(), 2u);  // they can't be repeated, either
  EXPECT_TRUE(has(warnings[1], "share their noise"));
}

TEST(RowCheck, RowsWithoutNoiseAreToldUnlessTheStudyAddsSome) {
  const auto exact = [](const RowMatrix& theta, std::span<const std::uint32_t>) {
    return std::vector<double>(theta.col(0).begin(), theta.col(0).end());
  };
  expect_one(check(exact), "no observation noise");
  EXPECT_TRUE(check(exact, true).empty());
  // The same random numbers in all rows look no other than none.
  const auto same = [](const RowMatrix& theta, std::span<const std::uint32_t>) {
    std::vector<double> x;
    for (Index i = 0; i < theta.rows(); ++i) x.push_back(theta(i, 0) + 0.1 * noise(0));
    return x;
  };
  expect_one(check(same), "whatever their seeds");
}

// A few values far out don't hide the noise of the others.
TEST(RowCheck, SkewedRowsHaveNoise) {
  const auto skewed = [](const RowMatrix& theta, std::span<const std::uint32_t> seeds) {
    std::vector<double> x = sound(theta, seeds);
    for (double& value : x) value = std::exp(40.0 * value);
    return x;
  };
  EXPECT_TRUE(check(skewed).empty());
}

TEST(RowCheck, LateRowsAreRepeated) {
  const auto reversed_at_the_end = [](const RowMatrix& theta,
                                      std::span<const std::uint32_t> seeds) {
    std::vector<double> x = sound(theta, seeds);
    if (theta.rows() > 30) std::reverse(x.end() - 30, x.end());
    return x;
  };
  Simulator simulator(reversed_at_the_end);
  const RowMatrix theta =
      RowMatrix::NullaryExpr(100, 1, [](Index i) { return std::fmod(0.7 * double(i), 1.0); });
  const sim::Trajectories rows = simulator.simulate(theta, kFirst);
  const std::string message = message_of<InputError>([&] {
    check_late_rows(simulator, {theta, rows, kFirst});
  });
  EXPECT_TRUE(has(message, "in another order"));
}

// Which is told by a look at the rows alone.
TEST(RowCheck, RowsThatAreAllTheSameArentJudged) {
  const auto constant = [](const RowMatrix& theta, std::span<const std::uint32_t>) {
    return std::vector<double>(static_cast<std::size_t>(theta.rows()), 3.0);
  };
  EXPECT_TRUE(check(constant).empty());
}

TEST(RowCheck, FewRowsArentJudged) {
  const auto exact = [](const RowMatrix& theta, std::span<const std::uint32_t>) {
    return std::vector<double>(theta.col(0).begin(), theta.col(0).end());
  };
  EXPECT_TRUE(check(exact, false, 7).empty());
}

}  // namespace
}  // namespace npdr::pipeline
