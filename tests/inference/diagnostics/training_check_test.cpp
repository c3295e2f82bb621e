#include "inference/diagnostics/training_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "core/random.h"

namespace npdr::inference {
namespace {

TrainingConfig checked_config() {
  TrainingConfig c;
  c.stop_after_epochs = 2;
  c.max_epochs = 5;
  return c;
}

TEST(TrainingCheck, StoppedByPatienceIsConverged) {
  const Vector training{{4.0, 2.0, 1.0, 0.5}}, validation{{5.0, 3.0, 3.1, 3.2}};
  const TrainingCheck found = check_training(training, validation, checked_config());
  EXPECT_TRUE(found.is_converged);
  EXPECT_EQ(found.num_epochs, 4);
  EXPECT_EQ(found.best_epoch, 2);
  EXPECT_DOUBLE_EQ(found.generalization_gap, 1.0);
}

TEST(TrainingCheck, StoppedByTheLimitIsNot) {
  const Vector falling{{5.0, 4.0, 3.0, 2.0, 1.0}}, flat{{5.0, 4.0, 3.0, 3.1, 3.1}};
  EXPECT_FALSE(check_training(falling, falling, checked_config()).is_converged);
  EXPECT_TRUE(check_training(flat, flat, checked_config()).is_converged);
}

// No epoch was better than the weights that it began with: patience ran out all the same.
TEST(TrainingCheck, NothingLeftToLearnFromTheBeginningIsConverged) {
  const Vector losses{{5.0, 4.0}};
  EXPECT_TRUE(check_training(losses, losses, checked_config()).is_converged);
}

TEST(TrainingCheck, WeightsThatJumpAboutAreNot) {
  const Vector validation{{4.0, 5.0, 5.0, 5.0}};
  for (const double loss : {1.6e13, std::nan("")}) {
    EXPECT_FALSE(
        check_training(Vector::Constant(4, loss), validation, checked_config()).is_converged);
  }
  EXPECT_TRUE(
      check_training(Vector::Constant(4, 900.0), validation, checked_config()).is_converged);
}

TEST(TrainingCheck, ValidationFarAboveTrainingDoesNotPass) {
  const Vector training{{4.0, -3.3, -3.5, -3.6}}, validation{{5.0, 2.0, 2.1, 2.2}};
  const TrainingCheck far = check_training(training, validation, checked_config());
  EXPECT_TRUE(far.is_converged);
  EXPECT_TRUE(far.is_far_from_training());
  EXPECT_FALSE(far.passes());
  EXPECT_TRUE(check_training(training, training, checked_config()).passes());
}

TEST(TrainingCheck, SaysHowMuchTheLastTenthOfTheEpochsBrought) {
  Vector losses = Vector::LinSpaced(20, 20.0, 1.0);  // by 1 nat an epoch
  TrainingConfig long_config = checked_config();
  long_config.max_epochs = 20;
  EXPECT_NEAR(check_training(losses, losses, long_config).recent_fall, 2.0, 1e-12);
  losses.tail(3).setConstant(4.0);
  EXPECT_NEAR(check_training(losses, losses, long_config).recent_fall, 0.0, 1e-12);
}

// Losses of a network that generalizes: means of -log N(u; 0, I) over n rows that differ only by
// chance. The header's rate is 1e-4 for 2 rows a parameter; 2e4 trials have 2 alarms by
// expectation, and more than 12 with probability 1e-6; fixed seed.
TEST(TrainingCheck, RarelyAccusesANetworkThatGeneralizes) {
  for (const Index dimension : {2, 15}) {
    const Index rows = 2 * dimension;
    int alarms = 0;
    for (std::uint64_t trial = 0; trial < 20'000; ++trial) {
      Stream stream({1, "training_check", 0, trial, static_cast<std::uint64_t>(dimension)});
      double excess = 0.0;  // of the mean loss over its expectation
      for (Index i = 0; i < rows * dimension; ++i) {
        const double u = stream.normal();
        excess += 0.5 * (u * u - 1.0) / static_cast<double>(rows);
      }
      const Vector training{{1.0, 1.0, 1.0}}, validation = training.array() + excess;
      alarms +=
          check_training(training, validation, checked_config()).is_far_from_training() ? 1 : 0;
    }
    EXPECT_LE(alarms, 12) << dimension;
  }
}

TEST(TrainingCheck, SkipsLossesThatAreNoNumbers) {
  const Vector losses{{std::nan(""), 2.0, 1.0, 3.0}};
  EXPECT_EQ(check_training(losses, losses, checked_config()).best_epoch, 3);
  EXPECT_THROW(check_training(losses, Vector(), checked_config()), InputError);
  EXPECT_THROW(check_training(losses, losses.head(2), checked_config()), InputError);
}

}  // namespace
}  // namespace npdr::inference
