/// Settings of a conditional density estimator, as a study gives them.
#pragma once

#include "core/enum_names.h"
#include "core/range.h"
#include "core/types.h"

namespace npdr::inference {

enum class EstimatorKind { maf, mdn, nsf, resnet };

/// What a kind of network learns.
enum class Estimate {
  density,
  mixture,  ///< a density whose Gaussians are known
  ratio,
};

/// Everything about a kind that others than its own files need.
struct EstimatorTraits : EnumRow<EstimatorKind> {
  std::string_view title, words;  ///< what a list says of it: one after the other
  Estimate estimate;
  bool stacks_transforms = false;  ///< num_transforms of them: a flow

  constexpr bool gives(Estimate asked) const {
    return estimate == asked || (asked == Estimate::density && estimate == Estimate::mixture);
  }
};

constexpr auto enum_table(EstimatorKind) {
  using enum EstimatorKind;
  using enum Estimate;
  return std::to_array<EstimatorTraits>(
      {{{maf, "maf"},
        "masked autoregressive flow",
        ": any shape with one bulge or a few",
        density,
        true},
       {{mdn, "mdn", "mog"}, "mixture of Gaussians", ": quick, for a few modes", mixture},
       {{nsf, "nsf"}, "neural spline flow", ": sharp and bent shapes, slower", density, true},
       {{resnet, "resnet"}, "residual network", ", for ratios alone (nre_a, nre_b)", ratio}});
}

constexpr EstimatorTraits traits_of(EstimatorKind kind) { return row_of(kind); }

/// In their documented order.
inline std::vector<EstimatorKind> kinds_that_give(Estimate asked) {
  std::vector<EstimatorKind> kinds = values_of<EstimatorKind>();
  std::erase_if(kinds, [=](EstimatorKind kind) { return !traits_of(kind).gives(asked); });
  return kinds;
}

struct EstimatorConfig {
  static constexpr Range kNumBins = {2, 100};
  static constexpr Range kNumNetworks = {1, 100};

  EstimatorKind kind = EstimatorKind::nsf;
  Index num_networks = 1;       ///< whose densities are averaged (ensemble.h)
  Index num_transforms = 5;     ///< of a flow
  Index num_bins = 5;           ///< "nsf": bins of each spline
  Index num_components = 10;    ///< "mdn": Gaussians in the mixture
  Index hidden_features = 50;   ///< width of each hidden layer
  Index num_hidden_layers = 2;  ///< hidden layers (per transform); blocks of "resnet"
};

}  // namespace npdr::inference
