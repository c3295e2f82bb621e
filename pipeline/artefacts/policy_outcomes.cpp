#include "pipeline/artefacts/policy_outcomes.h"

#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/schemas.h"

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

void describe(Layout f, PolicyTest& test, sim::PolicyTaskInfo info,
              const std::vector<Channel>& states, const PolicyGrid& grid) {
  f.attribute("success_means", info.success, "when a rollout is one, in words");
  f("policy", test.policy, {kPolicyParameter}, "the policy").columns(policy_columns(info));
  f("initial_states", test.initial_states, {kRow, {"C", "channel"}},
    "that rollouts begin from, the same for all methods of a seed")
      .columns(states);
  if (auto group = f.group("target", test.target)) {
    describe(*group, *test.target, {test.target->returns.cols()}, {kRow});
  }
  if (auto group = f.group("grid", test.grid)) describe(*group, *test.grid, grid);
}

}  // namespace

void write_policy_test(h5::File& file, const Study& study, const sim::PolicyTaskInfo& info,
                       PolicyTest test) {
  describe(Layout::writer(file), test, info,
           sim::make_simulator(study.simulator)->info().state_channels, study.policy.grid);
}

PolicyTest read_policy_test(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPolicyTestSchema);
  PolicyTest test;
  describe(Layout::reader(file), test, {}, {}, {});
  return test;
}

void list_policy_test(Layout f) {
  PolicyTest test;
  describe(f, test, {}, {}, {});
}

}  // namespace npdr::pipeline
