/// Helpers for the tests of ODE models.
#pragma once

#include <map>
#include <string>

#include "sim/cvode_reference.h"
#include "sim/ode_model.h"
#include "sim/replay.h"

namespace npdr::sim {

/// Nominal parameters of a model, but for `values`.
inline Vector theta_of(const OdeModel& model, const std::map<std::string, double>& values = {}) {
  Vector theta(static_cast<Index>(model.info().parameters.size()));
  Index p = 0;
  for (const Parameter& parameter : model.info().parameters) theta(p++) = parameter.nominal;
  for (const auto& [name, value] : values) theta(parameter_index(model.info(), name)) = value;
  return theta;
}

/// A rollout without actions from an initial state.
inline Excitation free_motion(const Vector& initial_state, Index steps) {
  return {initial_state, RowMatrix::Zero(steps, 1)};
}

/// All states (T + 1, S) of a rollout by a named integrator.
inline RowMatrix states_by(Integrator integrator, Index substeps, const OdeModel& model,
                           const Vector& theta, const Excitation& excitation) {
  SimulatorConfig config;
  config.integrator = integrator;
  config.substeps = substeps;
  return simulate(model, config, theta, excitation).states;
}

/// All states after the first (T, S) by CVODE with a tolerance of 1e-12.
inline RowMatrix reference_states(const OdeModel& model, const Vector& theta,
                                  const Excitation& excitation) {
  Rollout rollout{"", excitation.initial_state.transpose(), excitation.actions};
  RowMatrix states(rollout.num_steps(), excitation.initial_state.size());
  BatchReplay batch(model, theta.transpose());
  CvodeReference integrator(batch, model.info().dt, 1e-12);
  batch.run(integrator, rollout, 0, [&](Index t, ConstLanes y) {
    for (Index s = 0; s < states.cols(); ++s) states(t - 1, s) = y.row(s)[0];
  });
  return states;
}

/// Errors of integrators on one rollout: the largest difference of a state after the first to the
/// reference.
class IntegrationError {
 public:
  IntegrationError(const OdeModel& model, const Vector& theta, const Excitation& excitation)
      : model_(model),
        theta_(theta),
        excitation_(excitation),
        reference_(reference_states(model, theta, excitation)) {}

  double of(Integrator integrator, Index substeps) const {
    const RowMatrix states = states_by(integrator, substeps, model_, theta_, excitation_);
    return (states.bottomRows(reference_.rows()) - reference_).cwiseAbs().maxCoeff();
  }

 private:
  const OdeModel& model_;
  Vector theta_;
  Excitation excitation_;
  RowMatrix reference_;
};

/// f(y, applied; theta) of one lane, by the vectorized right-hand side.
inline Vector rhs_of(const OdeModel& model, const Vector& theta, const Vector& applied,
                     const Vector& y) {
  const RowMatrix thetas = theta.replicate(1, kLaneBlock);
  const RowMatrix actions = applied.replicate(1, kLaneBlock);
  const RowMatrix states = y.replicate(1, kLaneBlock);
  RowMatrix constants(model.num_constants(), kLaneBlock);
  RowMatrix slopes(y.size(), kLaneBlock);
  model.prepare(view(thetas), view(constants));
  model.rhs(view(constants), view(actions), view(states), view(slopes));
  return slopes.col(kLaneBlock - 1);
}

/// The action that one lane's system feels at step t.
inline double applied_action(const OdeModel& model, const Vector& theta, const RowMatrix& actions,
                             Index t) {
  const RowMatrix thetas = theta.replicate(1, kLaneBlock);
  RowMatrix constants(model.num_constants(), kLaneBlock);
  RowMatrix applied(1, kLaneBlock);
  model.prepare(view(thetas), view(constants));
  model.apply_action(in_every_lane(actions), t, view(constants), view(applied));
  return applied(0, kLaneBlock - 1);
}

}  // namespace npdr::sim
