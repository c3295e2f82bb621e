#include "sim/error_memory.h"

#include <algorithm>
#include <cmath>

namespace npdr::sim {
namespace {

// States of each segment, [begin, end).
std::vector<std::pair<Index, Index>> segments_of(const std::vector<char>& restarts) {
  std::vector<std::pair<Index, Index>> segments;
  for (Index k = 0; k < std::ssize(restarts); ++k) {
    if (restarts[static_cast<std::size_t>(k)] != 0 || k == 0) segments.emplace_back(k, k);
    segments.back().second = k + 1;
  }
  return segments;
}

double memory_of(const Eigen::VectorXd& z, const std::vector<std::pair<Index, Index>>& segments) {
  const double squares = z.squaredNorm();
  if (!(squares > 0.0)) return 1.0;
  Index longest = 0;
  for (const auto& [begin, end] : segments) longest = std::max(longest, end - begin);
  const auto correlation = [&](Index lag) {
    double sum = 0.0;
    for (const auto& [begin, end] : segments) {
      const Index n = std::max<Index>(end - begin - lag, 0);
      sum += z.segment(begin, n).dot(z.segment(std::min(begin + lag, end), n));
    }
    return sum / squares;
  };
  const double chance = 2.0 * std::sqrt(2.0 / static_cast<double>(z.size()));
  double memory = 1.0 + 2.0 * correlation(1);
  for (Index lag = 2; lag < longest; lag += 2) {
    const double pair = correlation(lag) + correlation(lag + 1);
    if (pair <= chance) break;
    memory += 2.0 * pair;
  }
  return std::max(memory, 0.0);
}

}  // namespace

double ErrorMemory::excess() const { return memory(worst_channel()) * size(worst_channel()); }

Index ErrorMemory::worst_channel() const {
  const Vector all = memory.array() * size.array();
  Index worst = 0;
  for (Index c = 1; c < all.size(); ++c) {
    if (!(all(c) <= all(worst)) && !std::isnan(all(worst))) worst = c;
  }
  return worst;
}

ErrorMemory memory_of(const RowMatrix& scores, const std::vector<char>& restarts) {
  const auto segments = segments_of(restarts);
  ErrorMemory result{scores.rows(), Vector(scores.cols()), Vector(scores.cols())};
  for (Index c = 0; c < scores.cols(); ++c) {
    const Eigen::VectorXd z = scores.col(c);
    result.memory(c) = memory_of(z, segments);
    result.size(c) = z.squaredNorm() / static_cast<double>(z.size());
  }
  return result;
}

double largest_by_chance(Index num_errors, Index num_channels) {
  const double standard_error = std::sqrt(6.0 / static_cast<double>(num_errors));
  const double count = 8.0 + std::log(static_cast<double>(num_channels));
  return 1.0 + count * standard_error;
}

}  // namespace npdr::sim
