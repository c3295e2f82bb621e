#include "sim/erk_integrator.h"

#include <arkode/arkode_erkstep.h>

#include <algorithm>
#include <array>

#include "core/error.h"

namespace npdr::sim {
namespace {

struct TableDeleter {
  void operator()(ARKodeButcherTable table) const { ARKodeButcherTable_Free(table); }
};
using TablePtr = std::unique_ptr<ARKodeButcherTableMem, TableDeleter>;

// ARKODE has no built-in table of the classical method.
TablePtr classical_table() {
  constexpr int stages = 4, order = 4, embedded_order = 0;
  std::array<double, 4> c = {0.0, 0.5, 0.5, 1.0};
  std::array<double, 16> a = {0.0, 0.0, 0.0, 0.0,  //
                              0.5, 0.0, 0.0, 0.0,  //
                              0.0, 0.5, 0.0, 0.0,  //
                              0.0, 0.0, 1.0, 0.0};
  std::array<double, 4> b = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};
  return TablePtr(ARKodeButcherTable_Create(stages, order, embedded_order, c.data(), a.data(),
                                            b.data(), nullptr));
}

TablePtr table_of(Integrator method) {
  switch (method) {
    case Integrator::erk2:
      return TablePtr(ARKodeButcherTable_LoadERK(ARKODE_HEUN_EULER_2_1_2));
    case Integrator::erk4:
      return classical_table();
    case Integrator::erk5:
      return TablePtr(ARKodeButcherTable_LoadERK(ARKODE_CASH_KARP_6_4_5));
    case Integrator::cvode:
      break;
  }
  throw InputError("'" + name_of(method) +
                   "' is no Runge-Kutta method; these are erk2, erk4, erk5");
}

// Error weights have no use with a fixed step (see sim/batch_vector.h).
int leave_weights(N_Vector /*y*/, N_Vector /*weights*/, void* /*self*/) { return 0; }

}  // namespace

ErkIntegrator::ErkIntegrator(Integrator method, BatchProblem& problem, double dt, Index substeps)
    : problem_(problem),
      step_(dt / static_cast<double>(substeps)),
      substeps_(substeps),
      context_(make_context()),
      initial_(make_batch_vector(problem.num_states() * problem.num_lanes(), context_.get())),
      ignored_(N_VClone(initial_.get())),
      arkode_(ERKStepCreate(evaluate_rhs, 0.0, initial_.get(), context_.get())) {
  require(arkode_ != nullptr, "ERKStepCreate");
  try {
    configure(method);
  } catch (...) {
    ERKStepFree(&arkode_);
    throw;
  }
}

ErkIntegrator::~ErkIntegrator() { ERKStepFree(&arkode_); }

void ErkIntegrator::configure(Integrator method) {
  const TablePtr table = table_of(method);
  require(ERKStepSetErrHandlerFn(arkode_, keep_message, this) == 0, "ERKStepSetErrHandlerFn");
  require(ERKStepSetUserData(arkode_, this) == 0, "ERKStepSetUserData");
  require(ERKStepSetTable(arkode_, table.get()) == 0, "ERKStepSetTable");
  require(ERKStepSetFixedStep(arkode_, step_) == 0, "ERKStepSetFixedStep");
  require(ERKStepSetMaxNumSteps(arkode_, -1) == 0, "ERKStepSetMaxNumSteps");
  require(ERKStepWFtolerances(arkode_, leave_weights) == 0, "ERKStepWFtolerances");
  // The history for interpolation is of no use here; this kind copies least.
  require(ERKStepSetInterpolantType(arkode_, ARK_INTERP_LAGRANGE) == 0,
          "ERKStepSetInterpolantType");
  require(ERKStepSetInterpolantDegree(arkode_, 1) == 0, "ERKStepSetInterpolantDegree");
  require(ERKStepSetPostprocessStepFn(arkode_, after_substep) == 0, "ERKStepSetPostprocessStepFn");
}

void ErkIntegrator::integrate(Index first, Index last, const double* y) {
  if (first >= last) return;
  current_ = first;
  last_ = last;
  substep_ = 0;
  std::copy_n(y, problem_.num_states() * problem_.num_lanes(), values(initial_.get()));
  problem_.begin_step(first);
  require(ERKStepReset(arkode_, 0.0, initial_.get()) == 0, "ERKStepReset");
  // Half a step early, so that rounding of the time can't change the number of steps.
  const double end = (static_cast<double>((last - first) * substeps_) - 0.5) * step_;
  double reached = 0.0;
  require(ERKStepEvolve(arkode_, end, ignored_.get(), &reached, ARK_NORMAL) >= 0, "ERKStepEvolve");
}

int ErkIntegrator::evaluate_rhs(double /*time*/, N_Vector y, N_Vector ydot, void* self) {
  static_cast<ErkIntegrator*>(self)->problem_.rhs(values(y), values(ydot));
  return 0;
}

int ErkIntegrator::after_substep(double /*time*/, N_Vector y, void* self) {
  auto& integrator = *static_cast<ErkIntegrator*>(self);
  if (++integrator.substep_ < integrator.substeps_) return 0;
  integrator.substep_ = 0;
  integrator.problem_.end_step(integrator.current_, values(y));
  if (++integrator.current_ < integrator.last_) {
    integrator.problem_.begin_step(integrator.current_);
  }
  return 0;
}

void ErkIntegrator::keep_message(int /*code*/, const char* /*module*/, const char* /*function*/,
                                 char* text, void* self) {
  static_cast<ErkIntegrator*>(self)->message_ = text;
}

void ErkIntegrator::require(bool ok, const char* call) const {
  if (!ok) throw Error(std::string(call) + " failed: " + message_);
}

}  // namespace npdr::sim
