/// Dynamic time warping of multivariate time series (Sakoe and Chiba 1978, "Dynamic programming
/// algorithm optimization for spoken word recognition", eqs. 18-20 with the symmetric form P = 0;
/// step pattern "symmetric2" of Giorgino 2009, "Computing and visualizing dynamic time warping
/// alignments in R: the dtw package").
///
/// With d(i, j) = |recorded_i - simulated_j|_2 over the channels, the accumulated cost is
///   D(i, j) = min( D(i-1, j) + d(i, j),  D(i, j-1) + d(i, j),  D(i-1, j-1) + 2 d(i, j) ),
///   D(0, 0) = d(0, 0)  (as Giorgino; Sakoe and Chiba start from 2 d(0, 0)).
/// Every path from (0, 0) to (n-1, m'-1) has weights that sum to n + m' - 1, so the normalized
/// distance is D(n-1, m'-1) / (n + m'). The whole recorded series is always explained. With an open
/// end it may be explained by the first m' simulated states alone: the m' with the smallest
/// normalized distance, and the smallest such m' when several tie. What is reported as the distance
/// is the accumulated cost there, not normalized.
#pragma once

#include <span>
#include <vector>

#include "core/types.h"

namespace npdr::analysis {

/// End of the warping path along the simulated series.
enum class DtwEnd {
  open,    ///< after any number of simulated states
  closed,  ///< after all of them
};

/// A warping distance, in the unit of the series (none, where they are normalized).
struct DtwResult {
  double distance = 0.0;             ///< accumulated cost D(n-1, end-1)
  double normalized_distance = 0.0;  ///< distance / (n + end)
  Index end = 0;                     ///< m', the number of simulated states that are matched
};

/// Distance of `simulated` (m, C) to `recorded` (n, C), in O(n m C) time and O(min(n, m)) memory.
/// A value that isn't finite, in either series, gives NaN distances and end 0.
/// Throws ShapeError when a series is empty or the channel counts differ. Thread-safe.
DtwResult dtw(const Eigen::Ref<const RowMatrix>& recorded,
              const Eigen::Ref<const RowMatrix>& simulated, DtwEnd end = DtwEnd::open);

/// Simulated series that dtw_batch() handles at once: one vector register of an AVX-512 machine.
inline constexpr Index kDtwLanes = 8;

/// The distances of many simulated series to one recorded series: element k is
/// dtw(recorded, simulated[k]), to the bit, whatever the other series hold. `simulated` is
/// (num_series, m, C), row-major. Vectorized over groups of kDtwLanes series, on this thread alone.
/// Memory O(kDtwLanes (n + m C)). Throws ShapeError as dtw() does, and when the size of `simulated`
/// is no multiple of num_series * C.
std::vector<DtwResult> dtw_batch(const Eigen::Ref<const RowMatrix>& recorded,
                                 std::span<const double> simulated, Index num_series,
                                 DtwEnd end = DtwEnd::open);

}  // namespace npdr::analysis
