#include "sim/erk_integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "core/constants.h"
#include "core/error.h"
#include "tests/sim/forced_decay.h"

namespace npdr::sim {
namespace {

constexpr double kDt = 0.1;
constexpr Index kErkSteps = 20;
const std::vector<double> kStart(kLaneBlock, 2.0);

double error_of(Integrator method, Index substeps) {
  ForcedDecay problem;
  ErkIntegrator integrator(method, problem, kDt, substeps);
  integrator.integrate(0, kErkSteps, kStart.data());
  double worst = 0.0;
  for (Index i = 0; i < kLaneBlock; ++i) {
    const double exact = ForcedDecay::exact(2.0, i, 0, kErkSteps, kDt);
    worst = std::max(worst, std::abs(problem.final_state[static_cast<std::size_t>(i)] - exact));
  }
  return worst;
}

// A first stage with the action of the step before would reduce every method to first order.
TEST(ErkIntegrator, HasItsOrderAlthoughActionsJump) {
  EXPECT_NEAR(std::log2(error_of(Integrator::erk2, 8) / error_of(Integrator::erk2, 16)), 2.0, 0.1);
  EXPECT_NEAR(std::log2(error_of(Integrator::erk4, 4) / error_of(Integrator::erk4, 8)), 4.0, 0.1);
  EXPECT_NEAR(std::log2(error_of(Integrator::erk5, 2) / error_of(Integrator::erk5, 4)), 5.0, 0.2);
}

TEST(ErkIntegrator, EvaluatesTheRightHandSideOncePerStageAndOnceMore) {
  for (const auto& [method, stages] :
       {std::pair{Integrator::erk2, 2}, {Integrator::erk4, 4}, {Integrator::erk5, 6}}) {
    ForcedDecay problem;
    ErkIntegrator integrator(method, problem, kDt, 3);
    integrator.integrate(0, kErkSteps, kStart.data());
    EXPECT_EQ(problem.num_rhs, stages * 3 * kErkSteps + 1) << name_of(method);
  }
}

TEST(ErkIntegrator, ReportsEveryStepOnce) {
  ForcedDecay problem;
  ErkIntegrator integrator(Integrator::erk4, problem, 1.0 / 3.0, 7);
  integrator.integrate(100, 1100, kStart.data());
  std::vector<Index> expected(1000);
  std::iota(expected.begin(), expected.end(), Index{100});
  EXPECT_EQ(problem.steps, expected);
}

TEST(ErkIntegrator, StartsAgainFromAnotherState) {
  ForcedDecay fresh, used;
  ErkIntegrator first(Integrator::erk4, fresh, kDt, 1), second(Integrator::erk4, used, kDt, 1);
  second.integrate(3, 17, std::vector<double>(kLaneBlock, -9.0).data());
  second.integrate(0, kErkSteps, kStart.data());
  first.integrate(0, kErkSteps, kStart.data());
  EXPECT_EQ(fresh.final_state, used.final_state);
}

TEST(ErkIntegrator, ALaneThatDivergedLeavesTheOthersAloneAndIsNotReported) {
  ForcedDecay healthy, sick;
  std::vector<double> start = kStart;
  start[3] = kNaN;
  start[5] = kInfinity;
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  ErkIntegrator(Integrator::erk4, healthy, kDt, 1).integrate(0, kErkSteps, kStart.data());
  ErkIntegrator(Integrator::erk4, sick, kDt, 1).integrate(0, kErkSteps, start.data());
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  for (const std::size_t i : {0u, 1u, 2u, 4u, 6u, 7u}) {
    EXPECT_EQ(sick.final_state[i], healthy.final_state[i]);
  }
  EXPECT_TRUE(std::isnan(sick.final_state[3]));
  EXPECT_FALSE(std::isfinite(sick.final_state[5]));
}

TEST(ErkIntegrator, RejectsAnotherMethod) {
  ForcedDecay problem;
  EXPECT_THROW(ErkIntegrator(Integrator::cvode, problem, kDt, 1), InputError);
}

}  // namespace
}  // namespace npdr::sim
