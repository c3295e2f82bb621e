#include "sim/segments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.h"

namespace npdr::sim {

Segments cut(const Target& target, Index segment_length) {
  const Index length = target.num_steps(), piece = segment_length > 0 ? segment_length : length;
  Segments all;
  all.dt = target.dt;
  all.num_rollouts = target.num_rollouts();
  all.actions.resize(all.num_rollouts * length, target.num_actions());
  all.first_states.resize(all.num_rollouts * ((length + piece - 1) / piece), target.num_states());
  for (Index h = 0; h < all.num_rollouts; ++h) {
    const Rollout& rollout = target.rollouts[static_cast<std::size_t>(h)];
    all.actions.middleRows(h * length, length) = rollout.actions;
    for (Index begin = 0; begin < length; begin += piece) {
      all.first_states.row(all.num_segments()) = rollout.states.row(begin);
      all.steps.push_back(std::min(piece, length - begin));
      all.past.push_back(begin);
    }
  }
  return all;
}

Trajectories empty_trajectories(const Segments& segments, Index num_rows, Index store_every) {
  Trajectories result;
  result.resize(num_rows, segments.num_rollouts,
                segments.num_steps() / segments.num_rollouts / store_every, segments.num_states());
  return result;
}

void store_states(const Segments& segments, const double* states, Index store_every, Index i,
                  Trajectories& result) {
  constexpr double largest = std::numeric_limits<float>::max();
  const Index channels = segments.num_states();
  const Index length = segments.num_steps() / segments.num_rollouts;
  const double* const end = states + segments.num_steps() * channels;
  if (!std::all_of(states, end, [](double value) { return std::abs(value) <= largest; })) {
    lose_row(i, RolloutStatus::diverged, result);
    return;
  }
  float* out = result.row(i).data();
  for (Index h = 0; h < segments.num_rollouts; ++h) {
    for (Index t = store_every; t <= length; t += store_every) {
      const double* const state = states + (h * length + t - 1) * channels;
      out = std::transform(state, state + channels, out,
                           [](double value) { return static_cast<float>(value); });
    }
  }
}

void lose_row(Index i, RolloutStatus status, Trajectories& result) {
  std::ranges::fill(result.row(i), kFloatNaN);
  result.status[static_cast<std::size_t>(i)] = status;
}

}  // namespace npdr::sim
