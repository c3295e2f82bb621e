#include "pipeline/predictions/inferred_noise.h"

#include <algorithm>

#include "core/constants.h"

namespace npdr::pipeline {
namespace {

RowMatrix values_of(double sim::NoiseValues::*parameter, const NoiseOfSamples& noise,
                    const sim::Trajectories& seen) {
  RowMatrix values(std::ssize(noise), seen.num_states);
  for (Index i = 0; i < values.rows(); ++i) {
    const auto row = static_cast<std::size_t>(i);
    const bool has_failed = seen.status[row] != sim::RolloutStatus::ok;
    for (Index c = 0; c < values.cols(); ++c) {
      values(i, c) = has_failed ? kNaN : noise[row][static_cast<std::size_t>(c)].*parameter;
    }
  }
  return values;
}

}  // namespace

std::optional<InferredNoise> inferred_noise(const sim::NoiseModel& model,
                                            const NoiseOfSamples& noise,
                                            const sim::Trajectories& seen) {
  if (noise.empty() || !model.has_unknown()) return std::nullopt;
  InferredNoise inferred{values_of(&sim::NoiseValues::scale, noise, seen), {}, {}};
  if (std::ranges::any_of(model.channels(), &sim::ChannelNoise::is_correlated)) {
    inferred.correlation = values_of(&sim::NoiseValues::correlation, noise, seen);
  }
  if (std::ranges::any_of(model.channels(), &sim::ChannelNoise::is_heavy_tailed)) {
    inferred.degrees_of_freedom = values_of(&sim::NoiseValues::degrees_of_freedom, noise, seen);
  }
  return inferred;
}

}  // namespace npdr::pipeline
