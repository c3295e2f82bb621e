#include <gtest/gtest.h>

#include "pipeline/stages/power_search.h"
#include "pipeline/stages/training_curves.h"

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
  PowerSearch search({});
  search.add(0.1, crps(0.30, 0.40));
  search.add(0.4, crps(0.10, 0.20));    // 0.15 with a standard error of 0.05
  search.add(0.2, crps(0.145, 0.245));  // a level that fell back
  search.add(0.3, crps(0.12, 0.22));
  EXPECT_EQ(search.scores().power, (Vector{{0.1, 0.2, 0.3, 0.4}}));
  EXPECT_EQ(search.scores().crps(1, 0), 0.145);
  EXPECT_EQ(search.best(), 0.2);
  EXPECT_TRUE(search.scores().ends_at_least(1.0));
  search.add(0.5, crps(0.11, 0.21));
  EXPECT_FALSE(search.scores().ends_at_least(1.0));
}

TEST(PowerSearch, RolloutsThatAgreeTellPowersApart) {
  PowerSearch search({});
  search.add(0.1, crps(0.106, 0.106));
  search.add(0.15, crps(0.101, 0.102));  // a hundredth more than the best, or a bit less
  search.add(0.2, crps(0.1, 0.102));
  EXPECT_EQ(search.best(), 0.15);
  search.add(0.4, crps(0.09, 0.09));
  EXPECT_EQ(search.best(), 0.4);
  EXPECT_TRUE(search.scores().ends_at_least(1.0));
  EXPECT_FALSE(search.scores().ends_at_least(0.4));
}

TEST(PowerSearch, EndsWhereMoreCantHelpOrIsOutOfReach) {
  PowerSearch search({});
  EXPECT_FALSE(search.is_over(1.0));
  search.add(0.1, crps(0.1, 0.2));
  EXPECT_FALSE(search.is_over(1.0));
  EXPECT_TRUE(search.is_over(0.1)) << "all that is wanted";
  search.add(0.15, crps(0.2, 0.3));
  search.add(0.21, crps(0.2, 0.3));
  EXPECT_FALSE(search.is_over(1.0)) << "twice the best, but few";
  search.add(0.25, crps(0.2, 0.3));
  EXPECT_TRUE(search.is_over(1.0));
  PowerSearch unsure({});
  unsure.add(0.1, crps(0.0, 0.24));
  unsure.add(0.2, crps(0.0, 0.22));
  EXPECT_EQ(unsure.best(), 0.1);
  EXPECT_FALSE(unsure.is_over(1.0)) << "scores are still falling";
  EXPECT_TRUE(unsure.scores().ends_at_least(1.0));
  PowerSearch stuck({});
  for (int i = 0; i <= 10; ++i) {
    EXPECT_FALSE(stuck.is_over(1.0)) << i;
    stuck.add(0.2 + 0.001 * i, crps(0.2 - 0.01 * i, 0.2 - 0.01 * i));
  }
  EXPECT_TRUE(stuck.is_over(1.0));
}

}  // namespace
}  // namespace npdr::pipeline
