/// Settings of a conditional density estimator, as a study gives them.
#pragma once

#include <string>
#include <vector>

#include "core/range.h"
#include "core/types.h"

namespace npdr::inference {

struct EstimatorConfig {
  static constexpr Range kNumBins = {2, 100};

  std::string kind = "maf";     ///< a name of estimator_names()
  Index num_transforms = 5;     ///< "maf", "nsf": autoregressive transforms
  Index num_bins = 8;           ///< "nsf": bins of each spline
  Index num_components = 10;    ///< "mdn": Gaussians in the mixture
  Index hidden_features = 50;   ///< width of each hidden layer
  Index num_hidden_layers = 2;  ///< hidden layers (per transform); blocks of "resnet"
};

/// "maf" (masked autoregressive flow), "mdn" (mixture of Gaussians; also spelt "mog"), "nsf"
/// (neural spline flow), "resnet" (residual network, for ratios alone).
std::vector<std::string> estimator_names();

}  // namespace npdr::inference
