#include "inference/diagnostics/local_c2st.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "tests/inference/diagnostics/exact_posterior.h"
#include "tests/thread_count.h"

namespace npdr::inference {
namespace {

const StreamId kLocalC2stId{1, "local_c2st", 0, 0, 0};
constexpr Index kNumSimulations = 300;

// Data of the linear-Gaussian task, whose prior is N(0, I) already, at its tenth simulation.
LocalC2stData data_of(const Fault& fault) {
  const LinearGaussian task(2);
  LocalC2stData data;
  data.u = sample_prior(task.prior(), kNumSimulations, 1);
  data.x = simulate(task.simulator(), data.u, 1, 1);
  data.u_sampled =
      rank_truths(amortized(task, fault), data.u, data.x, {.num_samples = 1}, {1, "", 0, 0, 0})
          .theta;
  data.x_o = data.x.row(10).transpose();
  data.u_at_x_o = GaussianPosterior(task, data.x_o, fault).sample(300, {1, "x_o", 0, 0, 0});
  return data;
}

// False-alarm rate 1 %, fixed seed.
TEST(LocalC2st, TheExactPosteriorPasses) {
  EXPECT_GT(local_c2st(data_of({}), kLocalC2stId, {.num_trials = 60}).p_value, 0.01);
}

TEST(LocalC2st, AWrongPosteriorFails) {
  EXPECT_LT(local_c2st(data_of({.width = 0.4}), kLocalC2stId, {.num_trials = 60}).p_value, 0.01);
  EXPECT_LT(local_c2st(data_of({.shift = 1.5}), kLocalC2stId, {.num_trials = 60}).p_value, 0.01);
}

TEST(LocalC2st, SameBitsForAnyThreadCount) {
  const LocalC2stData data = data_of({});
  expect_same_for_any_thread_count([&] {
    const LocalC2st found = local_c2st(data, kLocalC2stId, {.num_trials = 3, .max_epochs = 5});
    return std::pair(found.statistic, found.null);
  });
}

TEST(LocalC2st, RejectsWhatDoesntGoTogether) {
  LocalC2stData data = data_of({});
  data.x_o.conservativeResize(1);
  EXPECT_THROW(local_c2st(data, kLocalC2stId), ShapeError);
  data = data_of({});
  data.u.conservativeResize(39, Eigen::NoChange);
  data.u_sampled.conservativeResize(39, Eigen::NoChange);
  data.x.conservativeResize(39, Eigen::NoChange);
  EXPECT_THROW(local_c2st(data, kLocalC2stId), InputError);
}

}  // namespace
}  // namespace npdr::inference
