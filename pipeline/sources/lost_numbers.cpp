#include "pipeline/sources/lost_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace npdr::pipeline {
namespace {

// Of one row.
std::string lost_number(std::span<const double> row, const std::vector<Channel>& channels,
                        Index steps) {
  constexpr double largest = std::numeric_limits<float>::max();
  const auto lost =
      std::ranges::find_if(row, [](double value) { return !(std::abs(value) <= largest); });
  if (lost == row.end()) return "";
  const Index place = lost - row.begin(), count = std::ssize(channels);
  const std::string& label = channels[static_cast<std::size_t>(place % count)].label;
  const std::string found = fmt::format("{:.3g} in '{}'", *lost, label);
  if (steps == 0) return found;
  const Index step = place / count;
  return fmt::format("{}, step {} of rollout {}", found, step % steps + 1, step / steps + 1);
}

}  // namespace

std::optional<LostNumber> first_lost_number(std::span<const double> given,
                                            const sim::Trajectories& rows,
                                            const std::vector<Channel>& channels, Index steps) {
  const std::size_t size =
      given.size() / static_cast<std::size_t>(std::max<Index>(1, rows.num_rows));
  for (std::size_t i = 0; i < rows.status.size(); ++i) {
    if (rows.status[i] != sim::RolloutStatus::diverged) continue;
    const std::string found = lost_number(given.subspan(i * size, size), channels, steps);
    if (!found.empty()) return LostNumber{static_cast<Index>(i), found};
  }
  return std::nullopt;
}

}  // namespace npdr::pipeline
