/// Lists of an enumeration's values, as fields of a study hold them.
#pragma once

#include <string>
#include <vector>

#include "core/enum_names.h"

namespace npdr::pipeline {

/// All values, in the documented order.
template <NamedEnum E>
std::vector<E> values_of() {
  std::vector<E> values;
  for (const auto& row : enum_table(E{})) values.push_back(row.value);
  return values;
}

template <NamedEnum E>
std::vector<std::string> to_names(const std::vector<E>& values) {
  std::vector<std::string> names;
  for (const E value : values) names.push_back(name_of(value));
  return names;
}

}  // namespace npdr::pipeline
