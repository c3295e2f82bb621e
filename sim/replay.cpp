#include "sim/replay.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"
#include "core/error.h"
#include "core/parallel.h"
#include "sim/row_batches.h"

namespace npdr::sim {
namespace {

Index count(const std::vector<Channel>& channels) { return static_cast<Index>(channels.size()); }

// Writes stored state t of rollout h of every row of a batch that begins at row `first`.
void store(ConstLanes y, Index first, Index rows, Index h, Index t, Trajectories& result) {
  const Index states = result.num_states, row_size = result.row_size();
  float* out = result.values.data() + first * row_size + (h * result.num_steps + t) * states;
  for (Index i = 0; i < rows; ++i, out += row_size) {
    const double* state = y.data + i;
    for (Index s = 0; s < states; ++s, state += y.lanes) out[s] = static_cast<float>(*state);
  }
}

// A row fails as a whole: its rollouts are one sample of x.
void mark_failures(const std::vector<std::uint8_t>& failed, Trajectories& result) {
  for (Index i = 0; i < result.num_rows; ++i) {
    const auto begin = failed.begin() + i * result.num_rollouts;
    if (std::none_of(begin, begin + result.num_rollouts, [](auto f) { return f != 0; })) continue;
    result.status[static_cast<std::size_t>(i)] = RolloutStatus::diverged;
    std::ranges::fill(result.row(i), kFloatNaN);
  }
}

}  // namespace

BatchReplay::BatchReplay(const OdeModel& model, const Eigen::Ref<const RowMatrix>& theta)
    : model_(model) {
  const RowMatrix lanes = lanes_of(theta);
  constants_.setZero(model.num_constants(), lanes.cols());
  applied_.setZero(count(model.info().action_channels), lanes.cols());
  state_.setZero(count(model.info().state_channels), lanes.cols());
  finite_.setOnes(1, lanes.cols());
  for (Index i = 0; i < lanes.cols(); ++i) finite_(0, i) = lanes.col(i).allFinite() ? 1.0 : 0.0;
  model.prepare(view(lanes), view(constants_));
}

void BatchReplay::run(BatchIntegrator& integrator, const Rollout& rollout, Index segment_length,
                      const Sink& sink) {
  rollout_ = &rollout;
  sink_ = &sink;
  const Index steps = rollout.num_steps();
  const Index length = segment_length > 0 ? segment_length : steps;
  for (Index first = 0; first < steps; first += length) {
    state_.colwise() = rollout.states.row(first).transpose();
    integrator.integrate(first, std::min(first + length, steps), state_.data());
  }
}

void BatchReplay::begin_step(Index t) {
  model_.apply_action(in_every_lane(rollout_->actions), t, view(constants_), view(applied_));
}

void BatchReplay::rhs(const double* y, double* ydot) {
  const Index lanes = num_lanes();
  model_.rhs(view(constants_), view(applied_), {y, lanes}, {ydot, lanes});
}

void BatchReplay::end_step(Index t, const double* y) {
  constexpr double largest = std::numeric_limits<float>::max();
  double* const finite = finite_.data();
  for (Index s = 0; s < num_states(); ++s) {
    const double* const state = y + s * num_lanes();
    for_each_lane(num_lanes(),
                  [&](Index i) { finite[i] = std::abs(state[i]) <= largest ? finite[i] : 0.0; });
  }
  (*sink_)(t + 1, {y, num_lanes()});
}

Trajectories replay(const OdeModel& model, const SimulatorConfig& config, const Target& target,
                    const RowMatrix& theta) {
  const Index num_rollouts = target.num_rollouts();
  const Index batch_size = rows_per_batch(config.integrator, theta.rows() * num_rollouts);
  const Index num_batches = (theta.rows() + batch_size - 1) / batch_size;
  Trajectories result;
  result.resize(theta.rows(), num_rollouts, target.num_steps() / config.store_every,
                target.num_states());
  std::vector<std::uint8_t> failed(static_cast<std::size_t>(theta.rows() * num_rollouts));

  parallel_for(num_batches * num_rollouts, [&](Index task) {
    const Index h = task % num_rollouts;
    const Index first = task / num_rollouts * batch_size;
    const Index rows = std::min(batch_size, theta.rows() - first);
    BatchReplay batch(model, theta.middleRows(first, rows));
    const auto integrator = make_integrator(config.integrator, batch, target.dt, config.substeps);
    const auto keep = [&](Index t, ConstLanes y) {
      if (t % config.store_every != 0) return;
      store(y, first, rows, h, t / config.store_every - 1, result);
    };
    batch.run(*integrator, target.rollouts[static_cast<std::size_t>(h)], config.segment_length,
              keep);
    for (Index i = 0; i < rows; ++i) {
      failed[static_cast<std::size_t>((first + i) * num_rollouts + h)] = !batch.is_finite(i);
    }
  });
  mark_failures(failed, result);
  return result;
}

Rollout simulate(const OdeModel& model, const SimulatorConfig& config, const Vector& theta,
                 const Excitation& excitation) {
  const Index steps = excitation.actions.rows();
  Rollout rollout;
  rollout.actions = excitation.actions;
  rollout.states.setZero(steps + 1, excitation.initial_state.size());
  rollout.states.row(0) = excitation.initial_state.transpose();

  BatchReplay batch(model, theta.transpose());
  const auto integrator =
      make_integrator(config.integrator, batch, model.info().dt, config.substeps);
  const auto keep = [&](Index t, ConstLanes y) {
    for (Index s = 0; s < rollout.states.cols(); ++s) rollout.states(t, s) = y.row(s)[0];
  };
  batch.run(*integrator, rollout, 0, keep);
  if (!batch.is_finite(0)) {
    throw Error("the simulated target domain diverges; check its parameters and the integrator");
  }
  return rollout;
}

}  // namespace npdr::sim
