/// A PolicyTask made of an ODE model, a policy with its rewards, and the closed loop.
#pragma once

#include <memory>
#include <vector>

#include "sim/closed_loop.h"
#include "sim/control_task.h"
#include "sim/ode_model.h"
#include "sim/policy_task.h"
#include "sim/simulator.h"

namespace npdr::sim {

class OdePolicyTask final : public PolicyTask {
 public:
  /// `info`: the simulator's; `simulator`: its settings, of which integrator and substeps count.
  /// Throws InputError for a negative number of steps.
  OdePolicyTask(std::shared_ptr<const OdeModel> model, std::unique_ptr<ControlTask> task,
                SimulatorInfo info, const SimulatorConfig& simulator,
                const PolicyTaskConfig& config);

  const PolicyTaskInfo& info() const override { return task_info_; }
  PolicyRollouts run(const RowMatrix& theta, const RowMatrix& initial_states,
                     const RowMatrix& policies) const override;
  RecordedPolicyRollouts record(const RowMatrix& theta, const RowMatrix& initial_states,
                                const RowMatrix& policies) const override;
  std::vector<Index> possible_rows(const RowMatrix& theta) const override;
  RowMatrix initial_states(Index n, const StreamId& id) const override;

 private:
  void check_shapes(const RowMatrix& theta, const RowMatrix& initial_states,
                    const RowMatrix& policies) const;
  PolicyRollouts run_batches(const RowMatrix& theta, const RowMatrix& initial_states,
                             const RowMatrix& policies, std::vector<Rollout>* recorded) const;
  void take_outcome(const BatchClosedLoop& batch, Index lane,
                    const Eigen::Ref<const Eigen::RowVectorXd>& theta, Index row,
                    PolicyRollouts& result) const;

  std::shared_ptr<const OdeModel> model_;
  std::unique_ptr<ControlTask> task_;
  SimulatorInfo simulator_info_;
  PolicyTaskInfo task_info_;
  Integrator integrator_;
  Index substeps_;
};

}  // namespace npdr::sim
