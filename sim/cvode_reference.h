/// The reference integrator: SUNDIALS CVODE with error control, one rollout at a time.
///
/// Adams formulas of variable order and step with functional iteration, started anew at every time
/// step because the right-hand side jumps there. It shares the right-hand side and nothing else
/// with the fixed-step methods, so agreement between the two checks both. Slow: for checks, and for
/// studies whose systems are too stiff for a fixed step.
#pragma once

#include <sundials/sundials_nonlinearsolver.h>

#include <vector>

#include "sim/batch_integrator.h"
#include "sim/batch_vector.h"

namespace npdr::sim {

/// Relative and absolute local error tolerance of the integrator "cvode".
inline constexpr double kCvodeTolerance = 1e-8;

class CvodeReference final : public BatchIntegrator {
 public:
  CvodeReference(BatchProblem& problem, double dt, double tolerance = kCvodeTolerance);
  ~CvodeReference() override;
  CvodeReference(const CvodeReference&) = delete;
  CvodeReference& operator=(const CvodeReference&) = delete;

  /// Integrates lane 0; end_step() sees its state in every lane. Once CVODE can't go on (the state
  /// isn't finite, or a step needs more than 10,000 internal ones), the states are NaN. Prints
  /// nothing.
  void integrate(Index first, Index last, const double* y) override;

 private:
  struct SolverDeleter {
    void operator()(SUNNonlinearSolver solver) const { SUNNonlinSolFree(solver); }
  };
  using SolverPtr = std::unique_ptr<std::remove_pointer_t<SUNNonlinearSolver>, SolverDeleter>;

  static int evaluate_rhs(double time, N_Vector y, N_Vector ydot, void* self);

  void configure(double tolerance);
  bool advance();
  void broadcast(const double* state);

  BatchProblem& problem_;
  double dt_;  // [s]
  ContextPtr context_;
  VectorPtr state_;             // (S) of lane 0
  std::vector<double> lanes_;   // (S, L)
  std::vector<double> slopes_;  // (S, L)
  SolverPtr solver_;
  void* cvode_ = nullptr;
};

}  // namespace npdr::sim
