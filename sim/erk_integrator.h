/// Explicit Runge-Kutta with a fixed step, by SUNDIALS ARKODE's ERKStep.
///
/// One N_Vector holds the batch (sim/batch_vector.h), so that SUNDIALS' work per step is shared by
/// all lanes. Methods:
///   erk2  Heun's method, second order, 2 stages (ARKODE_HEUN_EULER_2_1_2)
///   erk4  the classical method, fourth order, 4 stages (Kutta 1901)
///   erk5  Cash and Karp 1990, fifth order, 6 stages (ARKODE_CASH_KARP_6_4_5)
///
/// Actions jump between steps. ERKStep evaluates f at the end of a step and takes that as the first
/// stage of the next, which would lag one action behind. Its hook after a step runs before this
/// evaluation, so the problem moves on to the next action there: first stages are right, and a step
/// costs no evaluation more than its stages (one more per integrate()).
#pragma once

#include <string>

#include "sim/batch_integrator.h"
#include "sim/batch_vector.h"

namespace npdr::sim {

class ErkIntegrator final : public BatchIntegrator {
 public:
  /// `method` is erk2, erk4 or erk5, or InputError; the step is dt / substeps, dt in [s].
  ErkIntegrator(Integrator method, BatchProblem& problem, double dt, Index substeps);
  ~ErkIntegrator() override;
  ErkIntegrator(const ErkIntegrator&) = delete;
  ErkIntegrator& operator=(const ErkIntegrator&) = delete;

  /// No memory is allocated and nothing is printed. Throws Error when ERKStep fails, which no state
  /// of the batch can cause.
  void integrate(Index first, Index last, const double* y) override;

 private:
  // Called by SUNDIALS; `self` is the integrator.
  static int evaluate_rhs(double time, N_Vector y, N_Vector ydot, void* self);
  static int after_substep(double time, N_Vector y, void* self);
  static void keep_message(int code, const char* module, const char* function, char* text,
                           void* self);

  void configure(Integrator method);
  void require(bool ok, const char* call) const;

  BatchProblem& problem_;
  double step_;          // [s]
  Index substeps_;       // per time step
  Index current_ = 0;    // time step
  Index last_ = 0;       // time step that integrate() ends before
  Index substep_ = 0;    // substeps of the current time step that are done
  std::string message_;  // of SUNDIALS
  ContextPtr context_;
  VectorPtr initial_;
  VectorPtr ignored_;  // state at the end of a call, interpolated: not ours
  void* arkode_ = nullptr;
};

}  // namespace npdr::sim
