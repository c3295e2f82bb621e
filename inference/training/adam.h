/// The Adam optimizer on a flat parameter vector.
#pragma once

#include "inference/estimators/parameters.h"

namespace npdr::inference {

/// Adam (Kingma and Ba 2015, algorithm 1), with bias correction:
///   m = b1 m + (1 - b1) g,  v = b2 v + (1 - b2) g^2,
///   p -= rate * (m / (1 - b1^t)) / (sqrt(v / (1 - b2^t)) + 1e-8).
/// b1 = 0.9, b2 = 0.999. One fused pass over memory.
class Adam {
 public:
  Adam(Index num_parameters, double learning_rate);

  /// One step. The gradient is scaled by `gradient_scale` first (for clipping, without a pass of
  /// its own).
  void step(const Parameters<float>& gradient, double gradient_scale,
            Parameters<float>& parameters);

  /// The state that a checkpoint must hold.
  struct State {
    Parameters<float> first_moment;
    Parameters<float> second_moment;
    std::int64_t num_steps = 0;
  };
  const State& state() const { return state_; }
  void set_state(State state) { state_ = std::move(state); }

 private:
  double learning_rate_;
  State state_;
};

/// Scale that brings a gradient to at most `clip_norm` in Euclidean norm: min(1, clip_norm / |g|);
/// 0 when the norm is not finite, so that a broken batch changes nothing.
double clip_scale(const Parameters<float>& gradient, double clip_norm);

}  // namespace npdr::inference
