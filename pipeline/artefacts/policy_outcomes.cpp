#include "pipeline/artefacts/policy_outcomes.h"

#include "pipeline/artefacts/described_artefact.h"
#include "pipeline/artefacts/policy_file.h"

namespace npdr::pipeline {
namespace {

void describe(Layout f, PolicyOutcomes& outcomes, const h5::Shape& shape, const Dims& dims) {
  f("return", outcomes.returns, dims, "of a rollout from each initial state", {.shape = shape});
  f("success", outcomes.success, dims, "1 or 0", {.shape = shape});
}

std::vector<double> points_of(const PolicyGridAxis& axis) {
  return axis.is_used() ? axis.points() : std::vector<double>();
}

void describe(Layout f, PolicyOutcomes& outcomes, const PolicyGrid& grid) {
  const std::vector<double> x = points_of(grid.x), y = points_of(grid.y);
  describe(f, outcomes, {std::ssize(x), std::ssize(y), outcomes.returns.cols()},
           {{"X", "x"}, {"Y", "y"}, kRow});
  if (f.reads()) return;
  f.attribute("x_parameter", std::string(grid.x.parameter), "a domain parameter");
  f.attribute("x_values", std::vector(x), "its values (X)");
  f.attribute("y_parameter", std::string(grid.y.parameter), "another");
  f.attribute("y_values", std::vector(y), "its values (Y)");
}

}  // namespace

void describe(Layout f, PolicyTest& test) {
  f.attribute("success_means", test.info.success, "when a rollout is one, in words");
  f("policy", test.policy, {kPolicyParameter}, "the policy").columns(policy_columns(test.info));
  f("initial_states", test.initial_states, {kRow, {"C", "channel"}},
    "that rollouts begin from, the same for all methods of a seed")
      .columns(test.states);
  if (auto group = f.group("target", test.target)) {
    describe(*group, *test.target, {test.target->returns.cols()}, {kRow});
  }
  if (auto group = f.group("grid", test.grid)) describe(*group, *test.grid, test.axes);
}
template struct Artefact<PolicyTest>;

}  // namespace npdr::pipeline
