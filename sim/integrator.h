/// The integrators that a study can choose for ODE simulators.
#pragma once

#include "core/enum_names.h"

namespace npdr::sim {

/// Runge-Kutta methods with a fixed step (erk_integrator.h), and CVODE, which picks its own steps
/// (cvode_reference.h).
enum class Integrator { erk4, erk2, erk5, cvode };
constexpr auto enum_table(Integrator) {
  using enum Integrator;
  return std::to_array<EnumRow<Integrator>>(
      {{erk4, "erk4"}, {erk2, "erk2"}, {erk5, "erk5"}, {cvode, "cvode"}});
}

}  // namespace npdr::sim
