#include "pipeline/import/rollout_copies.h"

namespace npdr::pipeline {
namespace {

bool is_copy(const Rollout& one, const Rollout& other) {
  return one.states.rows() == other.states.rows() && one.states == other.states &&
         one.actions == other.actions;
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> copies_of(const Target& recording) {
  std::vector<std::pair<std::size_t, std::size_t>> copies;
  for (std::size_t j = 1; j < recording.rollouts.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      if (!is_copy(recording.rollouts[i], recording.rollouts[j])) continue;
      copies.emplace_back(i, j);
      break;
    }
  }
  return copies;
}

}  // namespace npdr::pipeline
