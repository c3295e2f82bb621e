#include "pipeline/artefacts/policy_outcomes.h"

#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {
namespace {

void write_target(h5::File& file, const PolicyOutcomes& outcomes) {
  h5::Group group = file.create_group("target");
  const Vector returns = outcomes.returns.row(0), success = outcomes.success.row(0);
  group.write("return", returns).label_dimensions({"row"});
  group.write("success", success).label_dimensions({"row"});
}

void write_cube(h5::Group& group, const std::string& name, const h5::Shape& shape,
                const RowMatrix& values) {
  h5::Dataset dataset = group.create_dataset(name, h5::ElementType::f64, shape);
  dataset.write_rows<double>(0, shape[0], {values.data(), static_cast<std::size_t>(values.size())});
  dataset.label_dimensions({"x", "y", "row"});
}

void write_grid(h5::File& file, const PolicyGrid& grid, const PolicyOutcomes& outcomes) {
  h5::Group group = file.create_group("grid");
  group.set_attribute("x_parameter", grid.x.parameter);
  group.set_attribute("y_parameter", grid.y.parameter);
  const std::vector<double> x = grid.x.points(), y = grid.y.points();
  group.set_attribute("x_values", x);
  group.set_attribute("y_values", y);
  const h5::Shape shape = {static_cast<Index>(x.size()), static_cast<Index>(y.size()),
                           outcomes.returns.cols()};
  write_cube(group, "return", shape, outcomes.returns);
  write_cube(group, "success", shape, outcomes.success);
}

RowMatrix read_cube(const h5::Group& group, const std::string& name, Index n) {
  const h5::Dataset dataset = group.dataset(name);
  dataset.require_shape({-1, -1, n});
  RowMatrix values(dataset.shape()[0] * dataset.shape()[1], n);
  dataset.read_rows<double>(0, dataset.num_rows(),
                            {values.data(), static_cast<std::size_t>(values.size())});
  return values;
}

}  // namespace

void write_policy_test(h5::File& file, const Study& study, const sim::PolicyTaskInfo& info,
                       const PolicyTest& test) {
  file.set_attribute("success_means", info.success);
  write_policy_parameters(file, info, test.policy);
  h5::Dataset states = file.write("initial_states", test.initial_states);
  describe_columns(states, sim::make_simulator(study.simulator)->info().state_channels);
  states.label_dimensions({"row", "channel"});
  if (test.target) write_target(file, *test.target);
  if (test.grid) write_grid(file, study.policy.grid, *test.grid);
}

PolicyTest read_policy_test(const ArtefactFile& artefact) {
  const h5::File file = open_artefact(artefact, kPolicyTestSchema);
  PolicyTest test;
  test.policy = file.read_vector<double>("policy");
  test.initial_states = file.read_matrix<double>("initial_states");
  const Index n = test.initial_states.rows();
  if (file.has("target")) {
    const h5::Group group = file.group("target");
    test.target = {group.read_vector<double>("return", n).transpose(),
                   group.read_vector<double>("success", n).transpose()};
  }
  if (file.has("grid")) {
    const h5::Group group = file.group("grid");
    test.grid = {read_cube(group, "return", n), read_cube(group, "success", n)};
  }
  return test;
}

}  // namespace npdr::pipeline
