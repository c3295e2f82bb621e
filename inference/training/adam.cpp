#include "inference/training/adam.h"

#include <algorithm>
#include <cmath>

namespace npdr::inference {
namespace {

// As Kingma and Ba 2015 suggest.
constexpr double kDecay1 = 0.9, kDecay2 = 0.999;
constexpr auto kBeta1 = static_cast<float>(kDecay1), kBeta2 = static_cast<float>(kDecay2);
constexpr float kEpsilon = 1e-8f;

}  // namespace

Adam::Adam(Index num_parameters, double learning_rate) : learning_rate_(learning_rate) {
  state_.first_moment.setZero(num_parameters);
  state_.second_moment.setZero(num_parameters);
}

void Adam::step(const Parameters<float>& gradient, double gradient_scale,
                Parameters<float>& parameters) {
  if (gradient_scale == 0.0) return;
  ++state_.num_steps;
  const auto t = static_cast<double>(state_.num_steps);
  const auto rate = static_cast<float>(learning_rate_ / (1.0 - std::pow(kDecay1, t)));
  const auto root = static_cast<float>(1.0 / std::sqrt(1.0 - std::pow(kDecay2, t)));
  const auto scale = static_cast<float>(gradient_scale);
  const float* g = gradient.data();
  float* m = state_.first_moment.data();
  float* v = state_.second_moment.data();
  float* p = parameters.data();
  const Index count = parameters.size();
#pragma omp simd
  for (Index i = 0; i < count; ++i) {
    const float scaled = scale * g[i];
    m[i] = kBeta1 * m[i] + (1.0f - kBeta1) * scaled;
    v[i] = kBeta2 * v[i] + (1.0f - kBeta2) * scaled * scaled;
    p[i] -= rate * m[i] / (root * std::sqrt(v[i]) + kEpsilon);
  }
}

double clip_scale(const Parameters<float>& gradient, double clip_norm) {
  const double norm = static_cast<double>(gradient.norm());
  if (!std::isfinite(norm)) return 0.0;
  return norm > clip_norm ? clip_norm / norm : 1.0;
}

}  // namespace npdr::inference
