#include "sim/batch_integrator.h"

#include "sim/cvode_reference.h"
#include "sim/erk_integrator.h"

namespace npdr::sim {

std::unique_ptr<BatchIntegrator> make_integrator(Integrator integrator, BatchProblem& problem,
                                                 double dt, Index substeps) {
  if (integrator == Integrator::cvode) return std::make_unique<CvodeReference>(problem, dt);
  return std::make_unique<ErkIntegrator>(integrator, problem, dt, substeps);
}

bool is_adaptive(Integrator integrator) { return integrator == Integrator::cvode; }

}  // namespace npdr::sim
