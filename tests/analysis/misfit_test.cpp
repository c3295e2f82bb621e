#include "analysis/misfit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "core/constants.h"
#include "core/random.h"

namespace npdr::analysis {
namespace {

RowMatrix white(Index rows, Index columns, std::uint64_t number) {
  Stream stream({1, "misfit_test", 0, number, 0});
  RowMatrix errors(rows, columns);
  for (double& error : errors.reshaped<Eigen::RowMajor>()) error = stream.normal();
  return errors;
}

std::vector<RowMatrix> draws(Index rows, Index columns) {
  std::vector<RowMatrix> drawn;
  for (std::uint64_t b = 1; b <= 32; ++b) drawn.push_back(white(rows, columns, b));
  return drawn;
}

// Of n white numbers the size has a standard error of 1 / sqrt(2 n); 32 draws tell it to 13 %.
TEST(Misfit, IsTheErrorsSizeOverTheNoises) {
  const Misfit found = misfit(2.0 * white(1000, 2, 0), draws(1000, 2), 2);
  EXPECT_NEAR(found.times, 2.0, 0.1);
  EXPECT_NEAR(found.deviation, 1.0 / std::sqrt(4000.0), 0.5 / std::sqrt(4000.0));
  EXPECT_EQ(found.left.rows(), 20);
}

TEST(Misfit, LiesWhereErrorsAreFarLargerThanElsewhere) {
  RowMatrix errors = white(1000, 2, 0);
  EXPECT_FALSE(concentration(misfit(errors, draws(1000, 2), 2)));
  errors.block(100, 1, 100, 1) *= 20.0;  // of 500 states of rollout 0
  const auto found = concentration(misfit(errors, draws(1000, 2), 2));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->begin, 2);
  EXPECT_EQ(found->end, 4);
  EXPECT_EQ(found->channel, 1);
  EXPECT_EQ(found->rollout, 0);
  EXPECT_NEAR(found->there, 20.0, 3.0);
  EXPECT_NEAR(found->elsewhere, 1.0, 0.2);
}

// x' = -theta x + u, whose states are recorded with noise, the first ones, too; the action is a
// step that is recorded `late` samples before it acts.
constexpr double kStep = 0.05, kNoise = 0.01;

RowMatrix decay(const Target& target, Index segment_length, const RowMatrix& theta) {
  const Index steps = target.num_steps();
  RowMatrix states(theta.rows(), target.num_rollouts() * steps);
  for (Index i = 0; i < theta.rows(); ++i) {
    for (Index h = 0; h < target.num_rollouts(); ++h) {
      const Rollout& rollout = target.rollouts[static_cast<std::size_t>(h)];
      double x = 0.0;
      for (Index t = 0; t < steps; ++t) {
        if (t % segment_length == 0) x = rollout.states(t, 0);
        x += target.dt * (rollout.actions(t, 0) - theta(i, 0) * x);
        states(i, h * steps + t) = x;
      }
    }
  }
  return states;
}

Target recorded(Index late) {
  Target target{kStep, {{"x", "m"}}, {{"u", "m/s"}}, {}, "test"};
  for (Index h = 0; h < 2; ++h) {
    RowMatrix actions(200, 1);
    const auto pushed = [&](Index t) { return std::sin(0.3 * static_cast<double>((h + 1) * t)); };
    for (Index t = 0; t < 200; ++t) actions(t, 0) = pushed(t);
    target.rollouts.push_back({"", RowMatrix::Ones(201, 1), actions});
    RowMatrix& states = target.rollouts.back().states;
    for (Index t = 0; t < 200; ++t) {
      const double applied = actions(std::clamp<Index>(t - late, 0, 199), 0);
      states(t + 1, 0) = states(t, 0) + kStep * (applied - 1.5 * states(t, 0));
    }
    states += kNoise * white(201, 1, static_cast<std::uint64_t>(h));
  }
  return target;
}

class RecordingFit : public testing::Test {
 protected:
  const Replay replay_ = decay;
  const FitProblem problem_{replay_, Vector::Constant(1, 0.1), Vector::Constant(1, 5.0),
                            RowMatrix::Constant(2, 1, kNoise)};
};

TEST_F(RecordingFit, FindsParametersAndLeavesTheNoise) {
  const Fit found = fit(problem_, recorded(0), Vector::Constant(1, 3.0));
  EXPECT_NEAR(found.theta(0), 1.5, 0.05);
  EXPECT_NEAR(size_of(found.errors, 2), 1.0, 0.15);
  EXPECT_EQ(found.segment_length, 200);
  EXPECT_GT(size_of(fit(problem_, recorded(2), Vector::Constant(1, 1.5)).errors, 2), 1.3);
}

// A step of a linear device tells no scale of states from one of actions, which come first.
TEST_F(RecordingFit, NamesTheFaultOfARecording) {
  const auto with = [](Target target, double of_actions, double of_time) {
    for (Rollout& rollout : target.rollouts) rollout.actions *= of_actions;
    target.dt *= of_time;
    return target;
  };
  const std::vector<std::tuple<Target, std::string, std::string>> cases = {
      {recorded(2), "the device reacted to actions 2 samples late", "actions 2 samples later"},
      {recorded(-3), "actions were recorded 3 samples late", "actions 3 samples earlier"},
      {with(recorded(0), 1.25, 1.0), "actions were about 1.25 times too large",
       "actions 0.8 times as large"},
      {with(recorded(0), -1.0, 1.0), "actions had the opposite sign", "actions of the other sign"},
      {with(recorded(0), 1.0, 1.06), "time steps were 0.04982 s, not 0.053 s",
       "time steps of 0.04982 s"}};
  for (const auto& [recording, fault, change] : cases) {
    const auto cause = likeliest_cause(problem_, recording, Vector::Constant(1, 1.5));
    ASSERT_TRUE(cause) << fault;
    EXPECT_EQ(cause->fault, fault);
    EXPECT_EQ(cause->change, change);
    EXPECT_NEAR(cause->size, 1.0, 0.15) << fault;
  }
}

TEST_F(RecordingFit, LeavesOutChangesThatASimulatorRefuses) {
  const Replay replay = [](const Target& target, Index segment_length,
                           const RowMatrix& theta) -> RowMatrix {
    RowMatrix states = decay(target, segment_length, theta);
    if (target.dt != kStep || segment_length < target.num_steps()) states.setConstant(kNaN);
    return states;
  };
  const FitProblem problem{.replay = replay,
                           .lower = Vector::Constant(1, 0.1),
                           .upper = Vector::Constant(1, 5.0),
                           .sigma = RowMatrix::Constant(2, 1, kNoise),
                           .parts = 1};
  const auto cause = likeliest_cause(problem, recorded(2), Vector::Constant(1, 1.5));
  ASSERT_TRUE(cause);
  EXPECT_EQ(cause->change, "actions 2 samples later");
}

}  // namespace
}  // namespace npdr::analysis
