#include "sim/batch_integrator.h"

#include <array>

#include "core/error.h"
#include "core/text.h"
#include "sim/cvode_reference.h"
#include "sim/erk_integrator.h"
#include "sim/simulator.h"

namespace npdr::sim {
namespace {

using IntegratorPtr = std::unique_ptr<BatchIntegrator>;

IntegratorPtr make_erk(const std::string& name, BatchProblem& problem, double dt, Index substeps) {
  return std::make_unique<ErkIntegrator>(name, problem, dt, substeps);
}

IntegratorPtr make_cvode(const std::string& /*name*/, BatchProblem& problem, double dt,
                         Index /*substeps*/) {
  return std::make_unique<CvodeReference>(problem, dt);
}

struct Entry {
  const char* name;
  bool adaptive;
  IntegratorPtr (*make)(const std::string&, BatchProblem&, double, Index);
};

// Every integrator of ODE simulators; the first is the default.
constexpr std::array kIntegrators = {
    Entry{"erk4", false, make_erk},
    Entry{"erk2", false, make_erk},
    Entry{"erk5", false, make_erk},
    Entry{"cvode", true, make_cvode},
};

const Entry& find(const std::string& name) {
  for (const Entry& entry : kIntegrators) {
    if (name == entry.name) return entry;
  }
  throw InputError(unknown_name("integrator", name, integrator_names()));
}

}  // namespace

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kIntegrators) names.emplace_back(entry.name);
  return names;
}

IntegratorPtr make_integrator(const std::string& name, BatchProblem& problem, double dt,
                              Index substeps) {
  return find(name).make(name, problem, dt, substeps);
}

bool is_adaptive(const std::string& name) { return find(name).adaptive; }

}  // namespace npdr::sim
