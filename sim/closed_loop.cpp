#include "sim/closed_loop.h"

#include <algorithm>

#include "sim/row_batches.h"

namespace npdr::sim {
namespace {

// Steps until the next look at whether any rollout of the batch still goes on. Neighboring rows
// often have the same policy, and a policy that leaves the limits tends to do it everywhere.
constexpr Index kStepsPerCheck = 50;

}  // namespace

BatchClosedLoop::BatchClosedLoop(const OdeModel& model, const ControlTask& task, Index num_steps,
                                 const Eigen::Ref<const RowMatrix>& theta,
                                 const Eigen::Ref<const RowMatrix>& initial_states,
                                 const Eigen::Ref<const RowMatrix>& policies)
    : model_(model),
      task_(task),
      num_steps_(num_steps),
      policies_(lanes_of(policies)),
      state_(lanes_of(initial_states)) {
  const Index lanes = state_.cols(),
              channels = static_cast<Index>(model.info().action_channels.size());
  constants_.setZero(model.num_constants(), lanes);
  commanded_.setZero(channels, lanes);
  applied_.setZero(channels, lanes);
  actions_.setZero(num_steps * channels, lanes);
  alive_.setOnes(1, lanes);
  held_.setOnes(1, lanes);
  return_.setZero(1, lanes);
  steps_.setZero(1, lanes);
  scratch_.setZero(1, lanes);
  const RowMatrix thetas = lanes_of(theta);
  model.prepare(view(thetas), view(constants_));
}

void BatchClosedLoop::run(BatchIntegrator& integrator, const Sink& sink) {
  sink_ = &sink;
  end_rollouts_outside();
  for (Index first = 0; first < num_steps_; first += kStepsPerCheck) {
    if (alive_.maxCoeff() == 0.0) return;
    const RowMatrix start = state_;
    integrator.integrate(first, std::min(first + kStepsPerCheck, num_steps_), start.data());
  }
}

Vector BatchClosedLoop::action(Index t, Index row) const {
  return actions_.col(row).segment(t * num_actions(), num_actions());
}

ActionSeries BatchClosedLoop::series() const {
  return {actions_.data(), commanded_.size(), num_lanes(), 1};
}

void BatchClosedLoop::begin_step(Index t) {
  task_.act(view(policies_), view(state_), view(commanded_));
  task_.reward(view(state_), view(commanded_), scratch_.data());
  keep_actions(t);
  add_rewards();
  model_.apply_action(series(), t, view(constants_), view(applied_));
}

// Clips what is commanded; a rollout whose action isn't a number ends.
void BatchClosedLoop::keep_actions(Index t) {
  const double limit = task_.action_limit();
  double* const alive = alive_.data();
  for (Index a = 0; a < num_actions(); ++a) {
    const double* const from = commanded_.row(a).data();
    double* const to = actions_.row(t * num_actions() + a).data();
    for_each_lane(num_lanes(), [=](Index i) {
      const double u = from[i];
      to[i] = u > limit ? limit : (u < -limit ? -limit : u);
      alive[i] = u == u ? alive[i] : 0.0;
    });
  }
}

void BatchClosedLoop::add_rewards() {
  const double *const alive = alive_.data(), *const reward = scratch_.data();
  double *const sum = return_.data(), *const steps = steps_.data();
  for_each_lane(num_lanes(), [=](Index i) {
    sum[i] += alive[i] > 0.0 ? reward[i] : 0.0;
    steps[i] += alive[i];
  });
}

void BatchClosedLoop::end_rollouts_outside() {
  task_.within_limits(view(state_), scratch_.data());
  const double* const within = scratch_.data();
  double* const alive = alive_.data();
  for_each_lane(num_lanes(), [=](Index i) { alive[i] *= within[i]; });
}

void BatchClosedLoop::rhs(const double* y, double* ydot) {
  const Index lanes = num_lanes();
  model_.rhs(view(constants_), view(applied_), {y, lanes}, {ydot, lanes});
}

void BatchClosedLoop::end_step(Index t, const double* y) {
  std::copy_n(y, state_.size(), state_.data());
  end_rollouts_outside();
  if (t >= num_steps_ - task_.hold_steps()) {
    task_.is_held(view(state_), scratch_.data());
    held_.array() *= scratch_.array();
  }
  if (*sink_) (*sink_)(t + 1, {y, num_lanes()});
}

}  // namespace npdr::sim
