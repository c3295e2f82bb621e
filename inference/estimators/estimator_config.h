/// Settings of a conditional density estimator, as a study gives them.
#pragma once

#include "core/enum_names.h"
#include "core/range.h"
#include "core/types.h"

namespace npdr::inference {

enum class EstimatorKind {
  maf,     ///< masked autoregressive flow
  mdn,     ///< mixture of Gaussians
  nsf,     ///< neural spline flow
  resnet,  ///< residual network, for ratios alone
};
constexpr auto enum_table(EstimatorKind) {
  using enum EstimatorKind;
  return std::to_array<EnumRow<EstimatorKind>>(
      {{maf, "maf"}, {mdn, "mdn", "mog"}, {nsf, "nsf"}, {resnet, "resnet"}});
}

struct EstimatorConfig {
  static constexpr Range kNumBins = {2, 100};
  static constexpr Range kNumNetworks = {1, 100};

  EstimatorKind kind = EstimatorKind::nsf;
  Index num_networks = 1;       ///< whose densities are averaged (ensemble.h)
  Index num_transforms = 5;     ///< "maf", "nsf": autoregressive transforms
  Index num_bins = 5;           ///< "nsf": bins of each spline
  Index num_components = 10;    ///< "mdn": Gaussians in the mixture
  Index hidden_features = 50;   ///< width of each hidden layer
  Index num_hidden_layers = 2;  ///< hidden layers (per transform); blocks of "resnet"
};

}  // namespace npdr::inference
