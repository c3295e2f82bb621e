#include <gtest/gtest.h>

#include "pipeline/predictions/left_out.h"
#include "pipeline/stages/stage_parts.h"

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

LeftOutScore crps(double first, double second) { return {1.0, Vector{{first, second}}}; }

TEST(PowerSearch, TakesTheSmallestThatIsAboutAsGoodAsTheBest) {
  PowerScores search;
  add_power(search, 0.1, crps(0.30, 0.40));
  add_power(search, 0.4, crps(0.10, 0.20));    // 0.15 with a standard error of 0.05
  add_power(search, 0.2, crps(0.145, 0.245));  // a level that fell back
  add_power(search, 0.3, crps(0.12, 0.22));
  EXPECT_EQ(search.power, (Vector{{0.1, 0.2, 0.3, 0.4}}));
  EXPECT_EQ(search.crps(1, 0), 0.145);
  EXPECT_EQ(best_power(search), 0.2);
  EXPECT_TRUE(search.ends_at_least(1.0));
  add_power(search, 0.5, crps(0.11, 0.21));
  EXPECT_FALSE(search.ends_at_least(1.0));
}

TEST(PowerSearch, RolloutsThatAgreeTellPowersApart) {
  PowerScores search;
  add_power(search, 0.1, crps(0.106, 0.106));
  add_power(search, 0.15, crps(0.101, 0.102));  // a hundredth more than the best, or a bit less
  add_power(search, 0.2, crps(0.1, 0.102));
  EXPECT_EQ(best_power(search), 0.15);
  add_power(search, 0.4, crps(0.09, 0.09));
  EXPECT_EQ(best_power(search), 0.4);
  EXPECT_TRUE(search.ends_at_least(1.0));
  EXPECT_FALSE(search.ends_at_least(0.4));
}

TEST(PowerSearch, EndsWhereMoreCantHelpOrIsOutOfReach) {
  PowerScores search;
  EXPECT_FALSE(are_enough(search, 1.0));
  add_power(search, 0.1, crps(0.1, 0.2));
  EXPECT_FALSE(are_enough(search, 1.0));
  EXPECT_TRUE(are_enough(search, 0.1)) << "all that is wanted";
  add_power(search, 0.15, crps(0.2, 0.3));
  add_power(search, 0.21, crps(0.2, 0.3));
  EXPECT_FALSE(are_enough(search, 1.0)) << "twice the best, but few";
  add_power(search, 0.25, crps(0.2, 0.3));
  EXPECT_TRUE(are_enough(search, 1.0));
  PowerScores unsure;
  add_power(unsure, 0.1, crps(0.0, 0.24));
  add_power(unsure, 0.2, crps(0.0, 0.22));
  EXPECT_EQ(best_power(unsure), 0.1);
  EXPECT_FALSE(are_enough(unsure, 1.0)) << "scores are still falling";
  EXPECT_TRUE(unsure.ends_at_least(1.0));
  PowerScores stuck;
  for (int i = 0; i <= 10; ++i) {
    EXPECT_FALSE(are_enough(stuck, 1.0)) << i;
    add_power(stuck, 0.2 + 0.001 * i, crps(0.2 - 0.01 * i, 0.2 - 0.01 * i));
  }
  EXPECT_TRUE(are_enough(stuck, 1.0));
}

}  // namespace
}  // namespace npdr::pipeline
