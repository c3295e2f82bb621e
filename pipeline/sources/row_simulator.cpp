#include "pipeline/sources/row_simulator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace npdr::pipeline {

sim::Segments feature_segments(Index num_features) {
  return {.dt = 1.0,
          .num_rollouts = 1,
          .steps = {1},
          .past = {0},
          .first_states = RowMatrix::Zero(1, num_features),
          .actions = RowMatrix(1, 0)};
}

std::string find_lost_number(std::span<const double> row, const std::vector<Channel>& channels,
                             Index num_steps) {
  constexpr double largest = std::numeric_limits<float>::max();
  const auto lost =
      std::ranges::find_if(row, [](double value) { return !(std::abs(value) <= largest); });
  if (lost == row.end()) return "";
  const Index place = lost - row.begin(), count = std::ssize(channels);
  const std::string& label = channels[static_cast<std::size_t>(place % count)].label;
  const std::string found = fmt::format("{:.3g} in '{}'", *lost, label);
  if (num_steps == 1) return found;
  const Index step = place / count;
  return fmt::format("{}, step {} of rollout {}", found, step % num_steps + 1,
                     step / num_steps + 1);
}

std::uint32_t row_seed(StreamId first, Index i) {
  first.row += static_cast<std::uint64_t>(i);
  return Stream(first).bits() >> 1;
}

std::filesystem::path log_of(const std::filesystem::path& artefact) {
  return std::filesystem::path(artefact).replace_extension(".log");
}

}  // namespace npdr::pipeline
