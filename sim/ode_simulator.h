/// A Simulator made of an ODE model, a fixed-step or adaptive integrator, and the replay.
#pragma once

#include <memory>

#include "sim/ode_model.h"
#include "sim/simulator.h"

namespace npdr::sim {

class OdeSimulator final : public Simulator {
 public:
  /// Throws InputError for a config that is out of range; names the field, value and constraint.
  OdeSimulator(std::unique_ptr<OdeModel> model, const SimulatorConfig& config);

  const SimulatorInfo& info() const override { return info_; }
  Trajectories replay(const Target& target, const RowMatrix& theta) const override;
  Target behave(const Vector& theta, Index num_rollouts, std::uint64_t seed) const override;
  std::unique_ptr<RegressionForm> regression_form() const override {
    return model_->regression_form();
  }
  std::unique_ptr<PolicyTask> policy_task(const PolicyTaskConfig& config) const override;

 private:
  std::shared_ptr<const OdeModel> model_;
  SimulatorConfig config_;
  SimulatorInfo info_;  // the model's, with the config's parameters as nominal values
};

}  // namespace npdr::sim
