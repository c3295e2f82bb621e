/// Settings of Bayesian linear regression, as a study gives them.
#pragma once

#include "core/types.h"

namespace npdr::inference {

struct LinearRegressionConfig {
  Index window = 11;         ///< [states] of the smoother that differentiates recordings; odd
  Index num_samples = 1000;  ///< of the weights
};

}  // namespace npdr::inference
