#include "analysis/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/dtw.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/parallel.h"

namespace npdr::analysis {
namespace {

std::vector<Index> select_channels(const Target& target, const std::vector<Index>& wanted) {
  const Index count = target.num_states();
  if (wanted.empty()) {
    std::vector<Index> all(static_cast<std::size_t>(count));
    std::iota(all.begin(), all.end(), Index{0});
    return all;
  }
  std::vector<bool> seen(static_cast<std::size_t>(count), false);
  for (const Index c : wanted) {
    if (c < 0 || c >= count) {
      throw InputError(fmt::format("metrics: channel {}, must be in [0, {}]", c, count - 1));
    }
    if (seen[static_cast<std::size_t>(c)]) {
      throw InputError(fmt::format("metrics: channel {} ('{}') is listed twice", c,
                                   target.state_channels[static_cast<std::size_t>(c)].label));
    }
    seen[static_cast<std::size_t>(c)] = true;
  }
  return wanted;
}

// Recorded states 0, ..., T - 1 in the selected channels, SI.
RowMatrix compared_states(const Rollout& rollout, const std::vector<Index>& channels) {
  RowMatrix states(rollout.num_steps(), static_cast<Index>(channels.size()));
  for (Index c = 0; c < states.cols(); ++c) {
    states.col(c) =
        rollout.states.col(channels[static_cast<std::size_t>(c)]).head(rollout.num_steps());
  }
  return states;
}

void check_scale(const Vector& scale, const std::vector<Index>& channels, const Target& target,
                 const Rollout& rollout) {
  for (Index c = 0; c < scale.size(); ++c) {
    if (scale(c) > 0.0) continue;
    const Index channel = channels[static_cast<std::size_t>(c)];
    throw InputError(fmt::format(
        "metrics: channel '{}' of recorded rollout '{}' is 0 throughout, so errors can't be "
        "divided by its maximum; leave out the rollout",
        target.state_channels[static_cast<std::size_t>(channel)].label, rollout.name));
  }
}

}  // namespace

Metrics::Metrics(const Target& target, const MetricsConfig& config)
    : channels_(select_channels(target, config.channels)),
      num_states_(target.num_states()),
      num_steps_(target.num_steps()),
      segment_length_(config.segment_length),
      dt_(target.dt) {
  if (config.segment_length < 0) {
    throw InputError(
        fmt::format("metrics: segment_length = {}, must be >= 0", config.segment_length));
  }
  for (const Rollout& rollout : target.rollouts) {
    RowMatrix states = compared_states(rollout, channels_);
    Vector scale(states.cols());
    for (Index c = 0; c < scale.size(); ++c) scale(c) = states.col(c).lpNorm<Eigen::Infinity>();
    check_scale(scale, channels_, target, rollout);
    for (Index c = 0; c < scale.size(); ++c) states.col(c) /= scale(c);
    recorded_.push_back({std::move(states), scale, rollout.states.row(num_steps_ - 1),
                         rollout.states(Eigen::last, channels_)});
  }
}

void Metrics::check(const TrajectoryView& simulated) const {
  simulated.check();
  if (simulated.num_rollouts == static_cast<Index>(recorded_.size()) &&
      simulated.num_steps == num_steps_ && simulated.num_states == num_states_) {
    return;
  }
  throw ShapeError(fmt::format(
      "metrics: simulated rollouts have shape (H, T, C) = ({}, {}, {}), the target's ({}, {}, {})",
      simulated.num_rollouts, simulated.num_steps, simulated.num_states, recorded_.size(),
      num_steps_, num_states_));
}

void Metrics::normalize_rollout(const Eigen::Ref<const RowMatrixF>& states, Index h,
                                std::span<double> normalized) const {
  const Recorded& recorded = recorded_[static_cast<std::size_t>(h)];
  Eigen::Map<RowMatrix> result(normalized.data(), num_steps_, recorded.scale.size());
  for (Index c = 0; c < recorded.scale.size(); ++c) {
    const auto column = states.col(channels_[static_cast<std::size_t>(c)]).cast<double>();
    result.col(c).tail(num_steps_ - 1) = column.head(num_steps_ - 1) / recorded.scale(c);
  }
  const Index restart = segment_length_ > 0 ? segment_length_ : num_steps_;
  for (Index t = 0; t < num_steps_; t += restart) result.row(t) = recorded.states.row(t);
}

Vector Metrics::rmse(const TrajectoryView& simulated) const {
  check(simulated);
  const Index num_rollouts = simulated.num_rollouts;
  Vector result(simulated.num_samples);
  parallel_for(simulated.num_samples, [&](Index i) {
    if (!simulated.finite(i)) {
      result(i) = kNaN;
      return;
    }
    double sum = 0.0;
    for (Index h = 0; h < num_rollouts; ++h) {
      const RowMatrix& recorded = recorded_[static_cast<std::size_t>(h)].states;
      RowMatrix states(recorded.rows(), recorded.cols());
      normalize_rollout(simulated.rollout(i, h), h,
                        {states.data(), static_cast<std::size_t>(states.size())});
      sum += (states - recorded).array().square().colwise().mean().sqrt().mean();
    }
    result(i) = sum / static_cast<double>(num_rollouts);
  });
  return result;
}

Vector Metrics::mean_over_ends(const TrajectoryView& simulated,
                               const std::function<double(const RowMatrix&, Index)>& score) const {
  check(simulated);
  Vector result = Vector::Constant(simulated.num_samples, kNaN);
  RowMatrix end(2, num_states_);
  const Index of_last_segment =
      segment_length_ > 0 ? (num_steps_ - 1) % segment_length_ + 1 : num_steps_;
  const Index simulated_rows = std::min<Index>(2, of_last_segment);
  for (Index i = 0; i < result.size(); ++i) {
    if (!simulated.finite(i)) continue;
    double sum = 0.0;
    for (Index h = 0; h < simulated.num_rollouts; ++h) {
      const auto states = simulated.rollout(i, h);
      end.row(0) = recorded_[static_cast<std::size_t>(h)].restart;
      end.bottomRows(simulated_rows) = states.bottomRows(simulated_rows).cast<double>();
      sum += score(end, h);
    }
    result(i) = sum / static_cast<double>(simulated.num_rollouts);
  }
  return result;
}

Vector Metrics::final_error(const TrajectoryView& simulated) const {
  return mean_over_ends(simulated, [&](const RowMatrix& end, Index h) {
    return (end(1, channels_) - recorded_[static_cast<std::size_t>(h)].last).norm();
  });
}

Vector Metrics::goal(const TrajectoryView& simulated, const Goal& goal) const {
  return mean_over_ends(simulated, [&](const RowMatrix& end, Index) {
    const double distance = (end(1, goal.channels) - goal.place.transpose()).norm();
    const double speed = (end(1, goal.channels) - end(0, goal.channels)).norm() / dt_;
    return distance <= goal.radius && speed <= goal.speed ? 1.0 : 0.0;
  });
}

Vector Metrics::dtw(const TrajectoryView& simulated) const {
  check(simulated);
  const Index num_rollouts = simulated.num_rollouts;
  const Index num_groups = (simulated.num_samples + kDtwLanes - 1) / kDtwLanes;
  RowMatrix distances(num_rollouts, simulated.num_samples);
  parallel_for(num_groups * num_rollouts, [&](Index item) {
    const Index h = item / num_groups;
    const Index first = item % num_groups * kDtwLanes;
    const Index count = std::min(kDtwLanes, simulated.num_samples - first);
    const Recorded& recorded = recorded_[static_cast<std::size_t>(h)];
    const auto size = static_cast<std::size_t>(num_steps_ * recorded.states.cols());
    std::vector<double> series(static_cast<std::size_t>(count) * size);
    for (Index k = 0; k < count; ++k) {
      normalize_rollout(simulated.rollout(first + k, h), h,
                        std::span(series).subspan(static_cast<std::size_t>(k) * size, size));
    }
    const auto group = dtw_batch(recorded.states, series, count);
    for (Index k = 0; k < count; ++k) {
      distances(h, first + k) = group[static_cast<std::size_t>(k)].distance;
    }
  });
  Vector result = Vector::Constant(simulated.num_samples, kNaN);
  for (Index i = 0; i < result.size(); ++i) {
    // A value of a channel that doesn't count says just as well that the rollout failed.
    if (!simulated.finite(i)) continue;
    double sum = 0.0;
    for (Index h = 0; h < num_rollouts; ++h) sum += distances(h, i);
    result(i) = sum / static_cast<double>(num_rollouts);
  }
  return result;
}

}  // namespace npdr::analysis
