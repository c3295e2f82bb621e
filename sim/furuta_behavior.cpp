#include <array>
#include <cmath>
#include <numbers>

#include "core/random.h"
#include "sim/furuta.h"

namespace npdr::sim {
namespace {

// A sum of four sines, one in each of four bands of equal width in log frequency, faded in over the
// first second so that the arm doesn't drift off. The bands lie around the pole's own frequency
// (1.7 Hz at nominal). At nominal parameters the arm then stays within about 1 rad and the pole
// swings to about 2 rad, with rates like those of recorded swing-ups (15 and 25 rad/s); stronger
// sines make it tumble, which is chaotic. The sum stays within 4 V, so it never saturates.
constexpr std::array<double, 5> kBandEdges = {1.0, 1.5, 2.25, 3.4, 5.0};  // [Hz]
constexpr double kAmplitude = 1.0;                                        // [V] of each sine
constexpr double kFadeIn = 1.0;                                           // [s]

double envelope(double time) {
  return time < kFadeIn ? 0.5 - 0.5 * std::cos(std::numbers::pi * time / kFadeIn) : 1.0;
}

RowMatrix multi_sine(Stream& stream, Index steps, double dt) {
  RowMatrix voltage = RowMatrix::Zero(steps, 1);
  for (std::size_t band = 0; band + 1 < kBandEdges.size(); ++band) {
    const double ratio = kBandEdges[band + 1] / kBandEdges[band];
    const double frequency = kBandEdges[band] * std::pow(ratio, stream.uniform());
    const double phase = 2.0 * std::numbers::pi * stream.uniform();
    for (Index t = 0; t < steps; ++t) {
      const double time = static_cast<double>(t) * dt;
      voltage(t, 0) +=
          kAmplitude * envelope(time) * std::sin(2.0 * std::numbers::pi * frequency * time + phase);
    }
  }
  return voltage;
}

}  // namespace

Vector Furuta::initial_state(Stream& stream) {
  constexpr double degree = std::numbers::pi / 180.0;
  const Eigen::Vector4d half_width = Eigen::Vector4d(2.0, 1.0, 0.5, 0.5) * degree;
  Vector state(4);
  for (Index s = 0; s < 4; ++s) state(s) = half_width(s) * (2.0 * stream.uniform() - 1.0);
  return state;
}

Excitation Furuta::excite(Index rollout, std::uint64_t seed) const {
  Stream stream({seed, "behaviour", 0, static_cast<std::uint64_t>(rollout), 0});
  Excitation excitation;
  excitation.initial_state = initial_state(stream);
  excitation.actions = multi_sine(stream, info_.num_steps, info_.dt);
  return excitation;
}

}  // namespace npdr::sim
