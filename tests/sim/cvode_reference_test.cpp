#include "sim/cvode_reference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/constants.h"
#include "tests/sim/forced_decay.h"

namespace npdr::sim {
namespace {

TEST(CvodeReference, KeepsToItsTolerance) {
  for (const double tolerance : {1e-6, 1e-8, 1e-12}) {
    ForcedDecay problem;
    CvodeReference integrator(problem, 0.1, tolerance);
    integrator.integrate(0, 20, std::vector<double>(kLaneBlock, 2.0).data());
    // The tolerance bounds the error of one internal step; tens of them add up.
    EXPECT_NEAR(problem.final_state[0], ForcedDecay::exact(2.0, 0, 0, 20, 0.1), 30.0 * tolerance);
    EXPECT_EQ(problem.steps.size(), 20u);
  }
}

TEST(CvodeReference, ShowsTheStateOfTheFirstLaneInEveryLane) {
  ForcedDecay problem;
  CvodeReference(problem, 0.1).integrate(0, 5, std::vector<double>(kLaneBlock, 2.0).data());
  EXPECT_EQ(problem.final_state, std::vector<double>(kLaneBlock, problem.final_state[0]));
}

TEST(CvodeReference, GoesOnAsNanInSilenceOnceItDiverged) {
  ForcedDecay problem;
  testing::internal::CaptureStderr();
  CvodeReference(problem, 0.1).integrate(0, 5, std::vector<double>(kLaneBlock, kNaN).data());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(problem.steps.size(), 5u);
  EXPECT_TRUE(std::isnan(problem.final_state[0]));
}

}  // namespace
}  // namespace npdr::sim
