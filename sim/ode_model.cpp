#include "sim/ode_model.h"

namespace npdr::sim {

void OdeModel::apply_action(const ActionSeries& actions, Index t, ConstLanes /*constants*/,
                            Lanes applied) const {
  const auto channels = static_cast<Index>(info().action_channels.size());
  for (Index a = 0; a < channels; ++a) {
    double* const row = applied.row(a);
    for_each_lane(applied.lanes, [&](Index i) { row[i] = actions.at(t, a, i); });
  }
}

std::unique_ptr<RegressionForm> OdeModel::regression_form() const { return nullptr; }

std::unique_ptr<ControlTask> OdeModel::control_task(const Vector& /*model*/) const {
  return nullptr;
}

}  // namespace npdr::sim
