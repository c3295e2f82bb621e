#include "pipeline/stages/training_curves.h"

#include <gtest/gtest.h>

namespace npdr::pipeline {
namespace {

// Ten epochs, the best one `best`, as far above the training loss there as `gap`.
TrainingLosses losses(Index best, double gap) {
  const Vector training = Vector::LinSpaced(10, 2.0, 1.0);
  Vector validation = training.array() + gap + 1.0;
  validation(best - 1) = training(best - 1) + gap;
  return {training, validation};
}

class TrainingCurves : public testing::Test {
 protected:
  inference::TrainingCheck check() const { return check_training_curves(notes_, config_); }

  inference::TrainingConfig config_ = {.stop_after_epochs = 4, .max_epochs = 10};
  PosteriorNotes notes_ = {.rows = {},
                           .regression = {},
                           .certificate = {},
                           .losses = {losses(3, 0.1), losses(4, 0.5), losses(5, 0.2)},
                           .likelihood_losses = {},
                           .pool = {},
                           .powers = {},
                           .residuals = {}};
};

TEST_F(TrainingCurves, AreThoseOfTheNetworkThatLearnedLeast) {
  EXPECT_EQ(check().best_epoch, 4);
  EXPECT_TRUE(check().is_converged);
  notes_.losses.push_back(losses(9, 0.0));
  EXPECT_EQ(check().best_epoch, 9);
  EXPECT_FALSE(check().is_converged);
}

TEST_F(TrainingCurves, OfALikelihoodMustHaveConvergedWhereItCounts) {
  notes_.pool = PoolNotes{.powers = {0.5, 0.5}, .powers_at_x_o = {}};
  notes_.likelihood_losses = {losses(6, 5.0), losses(2, 0.1)};
  EXPECT_EQ(check().best_epoch, 4) << "its power makes up for its gap";
  notes_.likelihood_losses.push_back(losses(8, 0.1));
  EXPECT_EQ(check().best_epoch, 8);
  EXPECT_FALSE(check().is_converged);
  notes_.pool->powers = {1.0, 0.0};
  EXPECT_EQ(check().best_epoch, 4) << "it says nothing";
}

}  // namespace
}  // namespace npdr::pipeline
