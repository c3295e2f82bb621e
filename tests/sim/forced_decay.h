/// A batch problem with a closed-form solution, for the tests of integrators.
#pragma once

#include <cmath>
#include <vector>

#include "sim/batch_integrator.h"
#include "sim/lanes.h"

namespace npdr::sim {

/// Decays in lane i: y' = a_t - k_i y, with an action a_t that changes sign from each time step to
/// the next. Over a step of dt: y <- a / k + (y - a / k) exp(-k dt).
class ForcedDecay final : public BatchProblem {
 public:
  Index num_states() const override { return 1; }
  Index num_lanes() const override { return kLaneBlock; }
  void begin_step(Index t) override { action_ = action(t); }
  void rhs(const double* y, double* ydot) override {
    ++num_rhs;
    for (Index i = 0; i < kLaneBlock; ++i) ydot[i] = action_ - rate(i) * y[i];
  }
  void end_step(Index t, const double* y) override {
    steps.push_back(t);
    final_state.assign(y, y + kLaneBlock);
  }

  static double action(Index t) { return t % 2 == 0 ? 3.0 : -5.0; }
  static double rate(Index lane) { return 1.0 + 0.5 * static_cast<double>(lane); }
  static double exact(double y, Index lane, Index first, Index last, double dt) {
    for (Index t = first; t < last; ++t) {
      const double limit = action(t) / rate(lane);
      y = limit + (y - limit) * std::exp(-rate(lane) * dt);
    }
    return y;
  }

  Index num_rhs = 0;
  std::vector<Index> steps;
  std::vector<double> final_state;

 private:
  double action_ = 0.0;
};

}  // namespace npdr::sim
