#include "inference/samplers/flow_proposal.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "tests/inference/cells.h"

namespace npdr::inference {
namespace {

// Points along a bent line.
RowMatrix banana(Index n) {
  Stream stream(StreamId{1, "flow_proposal_test", 0, 0, 0});
  RowMatrix u(n, 2);
  for (Index i = 0; i < n; ++i) {
    u(i, 0) = stream.normal();
    u(i, 1) = 0.5 * u(i, 0) * u(i, 0) - 1.0 + 0.2 * stream.normal();
  }
  return u;
}

FlowProposal fitted() {
  return fit_flow(banana(4000), Vector::Ones(4000), Parameters<float>(), {1, "fit", 0, 0, 0});
}

TEST(FlowProposal, IsADensityAndDrawsFromIt) {
  const FlowProposal flow = fitted();
  // A grid of cells of 0.05 over [-10, 10]^2. Outside is less than 1e-3 of Student's t.
  constexpr Index side = 400;
  constexpr double step = 0.05;
  const RowMatrix grid = cells_of({-10.0, -10.0}, {10.0, 10.0}, side);
  const Vector cells = flow.log_density(grid).array().exp() * step * step;
  EXPECT_NEAR(cells.sum(), 1.0, 2e-3);
  const auto share_above = [](const RowMatrix& u, const Vector& weights, double limit) {
    return (u.col(1).array() > limit).select(weights, 0.0).sum() / weights.sum();
  };
  constexpr Index n = 20'000;
  const RowMatrix draws = flow.sample(n, StreamId{2, "draws", 0, 0, 0});
  for (const double limit : {-0.9, 0.0, 2.0, 4.0}) {
    const double p = share_above(grid, cells, limit);
    // Five standard errors (false-alarm rate 6e-7 each), and the grid's cells.
    EXPECT_NEAR(share_above(draws, Vector::Ones(n), limit), p, 5.0 * std::sqrt(p / n) + 5e-3);
  }
}

TEST(FlowProposal, HasTheTailsOfStudentsT) {
  const FlowProposal flow = fitted();
  const double far = flow.log_density(RowMatrix{{100.0, 0.0}})(0);
  const double twice = flow.log_density(RowMatrix{{200.0, 0.0}})(0);
  // Density over distance: -(nu + D) = -7.
  EXPECT_NEAR((twice - far) / std::log(2.0), -7.0, 0.1);
}

TEST(FlowProposal, RowsDoNotDependOnHowManyThereAre) {
  const FlowProposal flow = fitted();
  const StreamId id{3, "draws", 0, 0, 0};
  const RowMatrix many = flow.sample(150, id);
  EXPECT_EQ(flow.sample(7, id), many.topRows(7));
  EXPECT_EQ(flow.log_density(many.topRows(7)), flow.log_density(many).head(7));
}

TEST(FlowProposal, RefusesTheWeightsOfAnotherNetwork) {
  FlowProposal flow = fitted();
  EXPECT_NO_THROW(flow.check());
  flow.network.conservativeResize(3);
  EXPECT_THROW(flow.check(), ShapeError);
}

}  // namespace
}  // namespace npdr::inference
