#include "sim/trajectories.h"

namespace npdr::sim {

std::string_view to_string(RolloutStatus status) {
  switch (status) {
    case RolloutStatus::ok:
      return "ok";
    case RolloutStatus::diverged:
      return "diverged";
    case RolloutStatus::out_of_limits:
      return "out_of_limits";
    case RolloutStatus::left_scene:
      return "left_scene";
    case RolloutStatus::crashed:
      return "crashed";
    case RolloutStatus::timed_out:
      return "timed_out";
    case RolloutStatus::bad_output:
      return "bad_output";
  }
  return "unknown";
}

void Trajectories::resize(Index rows, Index rollouts, Index steps, Index states) {
  num_rows = rows;
  num_rollouts = rollouts;
  num_steps = steps;
  num_states = states;
  values.resize(static_cast<std::size_t>(rows * row_size()));
  status.assign(static_cast<std::size_t>(rows), RolloutStatus::ok);
}

void Trajectories::append(const Trajectories& rows) {
  if (num_rows == 0) {
    *this = rows;
    return;
  }
  num_rows += rows.num_rows;
  values.insert(values.end(), rows.values.begin(), rows.values.end());
  status.insert(status.end(), rows.status.begin(), rows.status.end());
}

std::span<float> Trajectories::row(Index i) {
  return std::span(values).subspan(static_cast<std::size_t>(i * row_size()),
                                   static_cast<std::size_t>(row_size()));
}

std::span<const float> Trajectories::row(Index i) const {
  return std::span(values).subspan(static_cast<std::size_t>(i * row_size()),
                                   static_cast<std::size_t>(row_size()));
}

Eigen::Map<const RowMatrixF> Trajectories::rollout(Index i, Index h) const {
  const float* begin = row(i).data() + h * num_steps * num_states;
  return {begin, num_steps, num_states};
}

}  // namespace npdr::sim
