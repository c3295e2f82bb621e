#include "inference/diagnostics/training_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"

namespace npdr::inference {
namespace {

TrainingConfig config() {
  TrainingConfig c;
  c.stop_after_epochs = 2;
  c.max_epochs = 5;
  return c;
}

TEST(TrainingCheck, StoppedByPatienceIsConverged) {
  const Vector training{{4.0, 2.0, 1.0, 0.5}}, validation{{5.0, 3.0, 3.1, 3.2}};
  const TrainingCheck found = check_training(training, validation, config());
  EXPECT_TRUE(found.is_converged);
  EXPECT_EQ(found.num_epochs, 4);
  EXPECT_EQ(found.best_epoch, 2);
  EXPECT_DOUBLE_EQ(found.generalization_gap, 1.0);
}

TEST(TrainingCheck, StoppedByTheLimitIsNot) {
  const Vector falling{{5.0, 4.0, 3.0, 2.0, 1.0}}, flat{{5.0, 4.0, 3.0, 3.1, 3.1}};
  EXPECT_FALSE(check_training(falling, falling, config()).is_converged);
  EXPECT_TRUE(check_training(flat, flat, config()).is_converged);
}

// No epoch was better than the weights that it began with: patience ran out all the same.
TEST(TrainingCheck, NothingLeftToLearnFromTheBeginningIsConverged) {
  const Vector losses{{5.0, 4.0}};
  EXPECT_TRUE(check_training(losses, losses, config()).is_converged);
}

TEST(TrainingCheck, WeightsThatJumpAboutAreNot) {
  const Vector validation{{4.0, 5.0, 5.0, 5.0}};
  for (const double loss : {1.6e13, std::nan("")}) {
    EXPECT_FALSE(check_training(Vector::Constant(4, loss), validation, config()).is_converged);
  }
  EXPECT_TRUE(check_training(Vector::Constant(4, 900.0), validation, config()).is_converged);
}

TEST(TrainingCheck, SkipsLossesThatAreNoNumbers) {
  const Vector losses{{std::nan(""), 2.0, 1.0, 3.0}};
  EXPECT_EQ(check_training(losses, losses, config()).best_epoch, 3);
  EXPECT_THROW(check_training(losses, Vector(), config()), InputError);
  EXPECT_THROW(check_training(losses, losses.head(2), config()), InputError);
}

}  // namespace
}  // namespace npdr::inference
