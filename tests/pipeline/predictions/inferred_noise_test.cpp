#include <gtest/gtest.h>

#include <cmath>

#include "pipeline/predictions/scores.h"

namespace npdr::pipeline {
namespace {

// Two samples, the second of which has failed, of one channel.
class InferredNoises : public ::testing::Test {
 protected:
  InferredNoises() {
    seen_.resize(2, 1, 3, 1);
    seen_.status = {sim::RolloutStatus::ok, sim::RolloutStatus::diverged};
  }

  std::optional<InferredNoise> of(const sim::ChannelNoise& noise) const {
    const sim::NoiseModel model({noise}, RowMatrix::Ones(1, 1), std::vector<char>{1, 0, 0});
    return inferred_noise(model, {{{0.2, 0.5, 4.0}}, {{0.3, 0.6, 5.0}}}, seen_);
  }

  sim::Trajectories seen_;
};

TEST_F(InferredNoises, AreNotThoseOfSamplesThatFailed) {
  const auto inferred = of({.scale = {0.2, 1.0},
                            .is_correlated = true,
                            .correlation = {0.5, 1.0},
                            .is_heavy_tailed = true,
                            .degrees_of_freedom = {4.0, 1.0}});
  ASSERT_TRUE(inferred.has_value());
  EXPECT_EQ(inferred->scale(0, 0), 0.2);
  EXPECT_EQ(inferred->correlation(0, 0), 0.5);
  EXPECT_EQ(inferred->degrees_of_freedom(0, 0), 4.0);
  for (const RowMatrix* values :
       {&inferred->scale, &inferred->correlation, &inferred->degrees_of_freedom}) {
    EXPECT_TRUE(std::isnan((*values)(1, 0)));
  }
}

TEST_F(InferredNoises, AreThereWhereAnyParameterIsUnknown) {
  EXPECT_FALSE(of({.scale = {0.2, 0.0}}).has_value());
  const auto white = of({.scale = {0.2, 1.0}});
  ASSERT_TRUE(white.has_value());
  EXPECT_EQ(white->correlation.size(), 0);
  EXPECT_EQ(white->degrees_of_freedom.size(), 0);
}

}  // namespace
}  // namespace npdr::pipeline
