/// The values that a setting may have: said once by the owner of the setting, for its own check and
/// for the readers of study files.
#pragma once

namespace npdr {

/// low <= value <= high.
struct Range {
  double low;
  double high;

  constexpr bool contains(double value) const { return value >= low && value <= high; }
};

}  // namespace npdr
