/// The columns of theta in files: names, units and bounds of the prior's parameters.
#pragma once

#include <vector>

#include "inference/prior.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// Sets the attributes labels, units, prior_lower and prior_upper of a dataset (n, D) whose columns
/// are the parameters of `prior`.
void describe_theta(h5::Dataset& dataset, const std::vector<inference::Marginal>& prior);

/// Writes theta (n, D) as the dataset "theta", with these attributes.
void write_theta(h5::Group& group, const std::vector<inference::Marginal>& prior,
                 const RowMatrix& theta);

}  // namespace npdr::pipeline
