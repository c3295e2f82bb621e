#include "pipeline/artefacts/theta_columns.h"

namespace npdr::pipeline {

void describe_theta(h5::Dataset& dataset, const std::vector<inference::Marginal>& prior) {
  std::vector<std::string> labels, units;
  std::vector<double> lower, upper;
  for (const inference::Marginal& marginal : prior) {
    labels.push_back(marginal.name);
    units.push_back(marginal.unit);
    lower.push_back(marginal.lower());
    upper.push_back(marginal.upper());
  }
  dataset.set_attribute("labels", labels);
  dataset.set_attribute("units", units);
  dataset.set_attribute("prior_lower", lower);
  dataset.set_attribute("prior_upper", upper);
  dataset.label_dimensions({"row", "parameter"});
}

void write_theta(h5::Group& group, const std::vector<inference::Marginal>& prior,
                 const RowMatrix& theta) {
  h5::Dataset dataset = group.write("theta", theta);
  describe_theta(dataset, prior);
}

}  // namespace npdr::pipeline
