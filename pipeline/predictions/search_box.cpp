#include "pipeline/predictions/search_box.h"

#include <algorithm>

namespace npdr::pipeline {

SearchBox search_box(const std::vector<inference::Marginal>& prior,
                     const sim::SimulatorInfo& info) {
  const auto dimension = static_cast<Index>(prior.size());
  SearchBox box{Vector(dimension), Vector(dimension)};
  for (Index d = 0; d < dimension; ++d) {
    const inference::Marginal& m = prior[static_cast<std::size_t>(d)];
    const sim::Parameter& parameter =
        info.parameters[static_cast<std::size_t>(sim::parameter_index(info, m.name))];
    const auto [lower, upper] = m.central_range(4.0);
    box.lower(d) = std::max(lower, parameter.lower);
    box.upper(d) = std::min(upper, parameter.upper);
  }
  return box;
}

}  // namespace npdr::pipeline
