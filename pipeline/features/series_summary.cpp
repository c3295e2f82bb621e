#include "pipeline/features/series_summary.h"

#include <fmt/format.h>

#include <cmath>

namespace npdr::pipeline {
namespace {

constexpr Index kValues = 5;

bool is_single(const inference::SeriesSelection& selection) { return selection.num_steps() == 1; }

}  // namespace

Vector summarize(std::span<const float> picked, const inference::SeriesSelection& selection) {
  const Index steps = selection.num_steps(), channels = selection.num_channels();
  if (is_single(selection)) {
    return Eigen::Map<const VectorF>(picked.data(), selection.num_values()).cast<double>();
  }
  Vector result(kValues * selection.num_rollouts * channels);
  Index next = 0;
  for (Index h = 0; h < selection.num_rollouts; ++h) {
    const Eigen::Map<const RowMatrixF> rollout(picked.data() + h * steps * channels, steps,
                                               channels);
    for (Index c = 0; c < channels; ++c) {
      const Vector values = rollout.col(c).cast<double>();
      const double mean = values.mean();
      const double deviation = std::sqrt((values.array() - mean).square().mean());
      result.segment(next, kValues) << mean, deviation, values.minCoeff(), values.maxCoeff(),
          values(steps - 1);
      next += kValues;
    }
  }
  return result;
}

std::vector<std::string> summary_names(const inference::SeriesSelection& selection,
                                       const std::vector<Channel>& channels) {
  std::vector<std::string> names;
  for (Index h = 0; h < selection.num_rollouts; ++h) {
    for (const Index c : selection.channels) {
      if (is_single(selection)) {
        names.push_back(channels[static_cast<std::size_t>(c)].label);
        continue;
      }
      for (const char* what : {"mean", "deviation", "minimum", "maximum", "last"}) {
        names.push_back(fmt::format("rollout {}, {}: {}", h + 1,
                                    channels[static_cast<std::size_t>(c)].label, what));
      }
    }
  }
  return names;
}

}  // namespace npdr::pipeline
