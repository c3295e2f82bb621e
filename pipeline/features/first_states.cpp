#include "pipeline/features/first_states.h"

#include <algorithm>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

// visit(row of first states, rollout, step)
template <class Visit>
void for_each_segment(const Target& target, const std::vector<Index>& starts, const Visit& visit) {
  const Index count = std::ssize(starts);
  for (Index i = 0; i < target.num_rollouts() * count; ++i) {
    visit(i, static_cast<std::size_t>(i / count), starts[static_cast<std::size_t>(i % count)]);
  }
}

}  // namespace

std::vector<Index> segment_starts(const sim::SimulatorConfig& simulator, Index num_steps) {
  const Index every = simulator.store_every;
  const Index length = simulator.segment_length > 0 ? simulator.segment_length : num_steps;
  std::vector<Index> starts;
  for (Index start = 0; start < num_steps; start += length) {
    if (start / every < std::min(start + length, num_steps) / every) starts.push_back(start);
  }
  return starts;
}

Target begun_in(const RowMatrix& first_states, const std::vector<Index>& starts, Target target) {
  if (first_states.rows() != target.num_rollouts() * std::ssize(starts) ||
      first_states.cols() != target.num_states()) {
    throw ShapeError("first states of another number of segments or channels");
  }
  for_each_segment(target, starts, [&](Index i, std::size_t h, Index step) {
    target.rollouts[h].states.row(step) = first_states.row(i);
  });
  return target;
}

RowMatrix first_states_of(const Target& target, const std::vector<Index>& starts) {
  RowMatrix states(target.num_rollouts() * std::ssize(starts), target.num_states());
  for_each_segment(target, starts, [&](Index i, std::size_t h, Index step) {
    states.row(i) = target.rollouts[h].states.row(step);
  });
  return states;
}

}  // namespace npdr::pipeline
