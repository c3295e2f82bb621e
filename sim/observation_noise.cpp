#include "sim/observation_noise.h"

#include <array>
#include <string>

#include "core/error.h"

namespace npdr::sim {

RowMatrix reference_amplitude(const Target& target) {
  RowMatrix amplitude(target.num_rollouts(), target.num_states());
  for (Index h = 0; h < amplitude.rows(); ++h) {
    const RowMatrix& states = target.rollouts[static_cast<std::size_t>(h)].states;
    amplitude.row(h) = states.bottomRows(target.num_steps()).cwiseAbs().colwise().maxCoeff();
  }
  return amplitude;
}

void add_observation_noise(std::span<float> series, const RowMatrix& exact, Stream& stream) {
  const auto values_per_step = static_cast<std::size_t>(exact.size());
  if (values_per_step == 0 || series.size() % values_per_step != 0) {
    throw ShapeError(
        "series of " + std::to_string(series.size()) +
        " values, must be a multiple of rollouts x channels = " + std::to_string(values_per_step));
  }
  const RowMatrixF deviation = exact.cast<float>();  // (H, C)
  const std::size_t steps = series.size() / values_per_step;
  // Drawn in pieces that stay in cache; their size is a multiple of what fill_normal makes at once.
  std::array<float, 1024> normals;
  std::size_t used = normals.size();
  float* value = series.data();
  for (Index h = 0; h < deviation.rows(); ++h) {
    for (std::size_t t = 0; t < steps; ++t) {
      for (Index c = 0; c < deviation.cols(); ++c, ++value, ++used) {
        if (used == normals.size()) {
          stream.fill_normal(normals);
          used = 0;
        }
        *value += deviation(h, c) * normals[used];
      }
    }
  }
}

}  // namespace npdr::sim
