/// Batches in structure-of-arrays order: how many rollouts are computed side by side.
///
/// A batch holds L lanes (one rollout a lane). A quantity q of all lanes is one contiguous row, so
/// that arithmetic on it runs on full vector registers. L is a multiple of kLaneBlock and every
/// loop over lanes advances by whole blocks: the same instructions are executed for a lane wherever
/// it sits and however many neighbors it has, hence its bits depend on its own inputs alone.
#pragma once

#include <type_traits>

#include "core/types.h"

namespace npdr::sim {

/// Lanes that are computed by one loop body: one AVX-512 register, two of AVX2, four of SSE2.
inline constexpr Index kLaneBlock = 8;

/// The smallest multiple of kLaneBlock that holds `rows` rows.
constexpr Index padded_lanes(Index rows) {
  return (rows + kLaneBlock - 1) / kLaneBlock * kLaneBlock;
}

/// A view of (rows, lanes) doubles; doesn't own them.
template <typename Scalar>
struct LaneView {
  Scalar* data = nullptr;
  Index lanes = 0;

  Scalar* row(Index q) const { return data + q * lanes; }
  operator LaneView<const Scalar>() const requires(!std::is_const_v<Scalar>) {
    return {data, lanes};
  }
};
using Lanes = LaneView<double>;
using ConstLanes = LaneView<const double>;

inline Lanes view(RowMatrix& values) { return {values.data(), values.cols()}; }
inline ConstLanes view(const RowMatrix& values) { return {values.data(), values.cols()}; }

/// Calls body(lane) for every lane, kLaneBlock of them at once. `lanes` is a multiple of
/// kLaneBlock; the body must be free of branches and must not depend on other lanes.
template <typename Body>
[[gnu::always_inline]] inline void for_each_lane(Index lanes, const Body& body) {
  for (Index block = 0; block < lanes; block += kLaneBlock) {
#pragma omp simd
    for (Index i = 0; i < kLaneBlock; ++i) body(block + i);
  }
}

}  // namespace npdr::sim
