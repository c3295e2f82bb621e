#include "sim/ode_model.h"

namespace npdr::sim {

void OdeModel::apply_action(const RowMatrix& actions, Index t, ConstLanes /*constants*/,
                            Lanes applied) const {
  for (Index a = 0; a < actions.cols(); ++a) {
    const double value = actions(t, a);
    double* const row = applied.row(a);
    for_each_lane(applied.lanes, [&](Index i) { row[i] = value; });
  }
}

std::unique_ptr<RegressionForm> OdeModel::regression_form() const { return nullptr; }

}  // namespace npdr::sim
