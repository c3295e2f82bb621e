/// The sizes of a network are at least 1.
#pragma once

#include <string>

#include "core/error.h"
#include "core/types.h"

namespace npdr::inference {

/// Throws InputError unless density_estimator.`name`, `value`, is at least 1.
inline void check_size(const char* name, Index value) {
  if (value >= 1) return;
  throw InputError(std::string("density_estimator.") + name + " = " + std::to_string(value) +
                   ", must be >= 1");
}

}  // namespace npdr::inference
