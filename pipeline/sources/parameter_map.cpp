#include "pipeline/sources/parameter_map.h"

namespace npdr::pipeline {

ParameterMap::ParameterMap(const Study& study, const sim::SimulatorInfo& info)
    : info_(info), nominal_values_(study.simulator.parameters) {
  for (const inference::Marginal& marginal : study.prior) {
    columns_.push_back(sim::parameter_index(info_, marginal.name));
  }
}

Vector ParameterMap::nominal(const std::map<std::string, double>& values) const {
  std::map<std::string, double> all = values;
  all.insert(nominal_values_.begin(), nominal_values_.end());
  return sim::complete_theta(info_, all);
}

RowMatrix ParameterMap::complete(const RowMatrix& theta) const {
  RowMatrix all = nominal().transpose().replicate(theta.rows(), 1);
  all(Eigen::all, columns_) = theta;
  return all;
}

RowMatrix ParameterMap::pick(const RowMatrix& complete) const {
  return complete(Eigen::all, columns_);
}

Vector ParameterMap::pick_one(const Vector& complete) const { return complete(columns_); }

}  // namespace npdr::pipeline
