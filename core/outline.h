/// Shapes seen from above, for figures of systems that move on a plane.
#pragma once

#include "core/types.h"

namespace npdr {

/// A closed polygon.
struct Outline {
  RowMatrix points;      ///< (k, 2) corners [m]
  bool is_fixed = true;  ///< the same for every theta
};

}  // namespace npdr
