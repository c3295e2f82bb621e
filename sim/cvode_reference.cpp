#include "sim/cvode_reference.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::sim {
namespace {

constexpr long kMaxInternalSteps = 10'000;  // per time step

// A rollout that diverges is data, not news.
void say_nothing(int /*code*/, const char* /*module*/, const char* /*function*/, char* /*text*/,
                 void* /*data*/) {}

void require(bool ok, const char* call) {
  if (!ok) throw Error(std::string(call) + " failed");
}

}  // namespace

CvodeReference::CvodeReference(BatchProblem& problem, double dt, double tolerance)
    : problem_(problem),
      dt_(dt),
      context_(make_context()),
      state_(N_VNew_Serial(problem.num_states(), context_.get())),
      lanes_(static_cast<std::size_t>(problem.num_states() * problem.num_lanes())),
      slopes_(lanes_.size()),
      solver_(SUNNonlinSol_FixedPoint(state_.get(), 0, context_.get())),
      cvode_(CVodeCreate(CV_ADAMS, context_.get())) {
  require(cvode_ != nullptr, "CVodeCreate");
  try {
    configure(tolerance);
  } catch (...) {
    CVodeFree(&cvode_);
    throw;
  }
}

CvodeReference::~CvodeReference() { CVodeFree(&cvode_); }

void CvodeReference::configure(double tolerance) {
  require(CVodeSetErrHandlerFn(cvode_, say_nothing, nullptr) == 0, "CVodeSetErrHandlerFn");
  require(CVodeSetUserData(cvode_, this) == 0, "CVodeSetUserData");
  require(CVodeInit(cvode_, evaluate_rhs, 0.0, state_.get()) == 0, "CVodeInit");
  require(CVodeSStolerances(cvode_, tolerance, tolerance) == 0, "CVodeSStolerances");
  require(CVodeSetNonlinearSolver(cvode_, solver_.get()) == 0, "CVodeSetNonlinearSolver");
  require(CVodeSetMaxNumSteps(cvode_, kMaxInternalSteps) == 0, "CVodeSetMaxNumSteps");
}

void CvodeReference::integrate(Index first, Index last, const double* y) {
  double* const state = values(state_.get());
  for (Index s = 0; s < problem_.num_states(); ++s) state[s] = y[s * problem_.num_lanes()];
  bool alive = true;
  for (Index t = first; t < last; ++t) {
    problem_.begin_step(t);
    alive = alive && advance();
    if (!alive) std::fill_n(state, problem_.num_states(), kNaN);
    broadcast(state);
    problem_.end_step(t, lanes_.data());
  }
}

bool CvodeReference::advance() {
  double reached = 0.0;
  return CVodeReInit(cvode_, 0.0, state_.get()) == CV_SUCCESS &&
         CVodeSetStopTime(cvode_, dt_) == CV_SUCCESS &&
         CVode(cvode_, dt_, state_.get(), &reached, CV_NORMAL) >= 0;
}

void CvodeReference::broadcast(const double* state) {
  const auto num_lanes = static_cast<std::ptrdiff_t>(problem_.num_lanes());
  for (Index s = 0; s < problem_.num_states(); ++s) {
    std::fill_n(lanes_.begin() + s * num_lanes, num_lanes, state[s]);
  }
}

int CvodeReference::evaluate_rhs(double /*time*/, N_Vector y, N_Vector ydot, void* self) {
  auto& integrator = *static_cast<CvodeReference*>(self);
  BatchProblem& problem = integrator.problem_;
  integrator.broadcast(values(y));
  problem.rhs(integrator.lanes_.data(), integrator.slopes_.data());
  double* const slope = values(ydot);
  bool finite = true;
  for (Index s = 0; s < problem.num_states(); ++s) {
    slope[s] = integrator.slopes_[static_cast<std::size_t>(s * problem.num_lanes())];
    finite = finite && std::isfinite(slope[s]);
  }
  return finite ? 0 : 1;  // 1: CVODE may try a smaller step
}

}  // namespace npdr::sim
