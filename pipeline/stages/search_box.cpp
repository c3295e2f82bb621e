#include "pipeline/stages/search_box.h"

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
    const bool is_normal = m.kind == inference::Marginal::Kind::normal;
    box.lower(d) = std::max(is_normal ? m.a - 4.0 * m.b : m.a, parameter.lower);
    box.upper(d) = std::min(is_normal ? m.a + 4.0 * m.b : m.b, parameter.upper);
  }
  return box;
}

}  // namespace npdr::pipeline
