// Compiled with -ffp-contract=off: whether a product and a sum are fused must not depend on how the
// compiler vectorized a loop, for the scalar and the batched form to agree to the bit.
#include "analysis/dtw.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/constants.h"
#include "core/error.h"

namespace npdr::analysis {
namespace {

// Replaces column j - 1 of D by column j, for kLanes stepped series at once.
//   held (n, channels): the series along the column, the same for every lane
//   stepped (channels, kLanes): state j of each lane's series
//   column (n, kLanes): D(., j - 1) on entry, D(., j) on return
//   below_first: what lies before the first entry of the column; 0 for j = 0, infinity after that
// kChannels is the number of channels when positive, so that the loop over them unrolls and the one
// over lanes vectorizes; kChannels = 0 takes any number, slowly.
template <int kLanes, int kChannels>
void advance_column(const double* __restrict held, Index n, Index channels,
                    const double* __restrict stepped, double below_first,
                    double* __restrict column) {
  const Index num_channels = kChannels > 0 ? kChannels : channels;
  std::array<double, kLanes> below;
  std::array<double, kLanes> diagonal;
  below.fill(below_first);
  diagonal.fill(kInfinity);
  for (Index i = 0; i < n; ++i) {
    const double* held_i = held + i * num_channels;
    double* cell = column + i * kLanes;
#pragma omp simd
    for (int l = 0; l < kLanes; ++l) {
      double squares = 0.0;
      for (Index c = 0; c < num_channels; ++c) {
        const double difference = held_i[c] - stepped[c * kLanes + l];
        squares += difference * difference;
      }
      const double d = std::sqrt(squares);
      const double left = cell[l];
      const double cost = std::min(std::min(left, below[l]), diagonal[l] + d) + d;
      diagonal[l] = left;
      below[l] = cost;
      cell[l] = cost;
    }
  }
}

using AdvanceColumn = void (*)(const double*, Index, Index, const double*, double, double*);

template <int kLanes, int... kChannels>
AdvanceColumn select(Index channels, std::integer_sequence<int, kChannels...>) {
  constexpr std::array<AdvanceColumn, sizeof...(kChannels)> table = {
      &advance_column<kLanes, kChannels>...};
  const auto index = static_cast<std::size_t>(channels);
  return table[index < table.size() ? index : 0];
}

// The unrolled form for 1 to 16 channels, the general one beyond.
template <int kLanes>
AdvanceColumn select_advance_column(Index channels) {
  return select<kLanes>(channels, std::make_integer_sequence<int, 17>{});
}

void check_series(const Eigen::Ref<const RowMatrix>& recorded, Index m, Index channels) {
  const Index n = recorded.rows();
  if (n > 0 && m > 0 && channels > 0 && recorded.cols() == channels) return;
  throw ShapeError("dtw: recorded series has shape (" + std::to_string(n) + ", " +
                   std::to_string(recorded.cols()) + "), simulated (" + std::to_string(m) + ", " +
                   std::to_string(channels) + "); neither may be empty, channels must agree");
}

// The end with the smallest normalized distance so far; the first of several that tie.
void offer_end(DtwResult& best, Index n, Index end, double distance) {
  const double normalized = distance / static_cast<double>(n + end);
  if (best.end > 0 && normalized >= best.normalized_distance) return;
  best = {distance, normalized, end};
}

// Keeps the column along the recorded series and steps along kLanes simulated ones, each stored as
// simulated (m, channels, kLanes).
template <int kLanes>
std::array<DtwResult, kLanes> step_along_simulated(const RowMatrix& recorded,
                                                   const double* simulated, Index m, DtwEnd end) {
  const Index n = recorded.rows();
  const Index channels = recorded.cols();
  const AdvanceColumn advance = select_advance_column<kLanes>(channels);
  std::vector<double> column(static_cast<std::size_t>(n * kLanes), kInfinity);
  const double* last = column.data() + (n - 1) * kLanes;
  std::array<DtwResult, kLanes> best;
  for (Index j = 0; j < m; ++j) {
    advance(recorded.data(), n, channels, simulated + j * channels * kLanes,
            j == 0 ? 0.0 : kInfinity, column.data());
    if (end == DtwEnd::closed && j + 1 < m) continue;
    for (std::size_t l = 0; l < kLanes; ++l) offer_end(best[l], n, j + 1, last[l]);
  }
  return best;
}

// Keeps the column along the simulated series, which is the shorter one, and steps along the
// recorded one: D is symmetric in the two, so the costs have the same bits.
DtwResult step_along_recorded(const RowMatrix& recorded, const RowMatrix& simulated, DtwEnd end) {
  const Index n = recorded.rows();
  const Index m = simulated.rows();
  const Index channels = recorded.cols();
  const AdvanceColumn advance = select_advance_column<1>(channels);
  std::vector<double> column(static_cast<std::size_t>(m), kInfinity);
  for (Index i = 0; i < n; ++i) {
    advance(simulated.data(), m, channels, recorded.data() + i * channels, i == 0 ? 0.0 : kInfinity,
            column.data());
  }
  DtwResult best;
  for (Index j = end == DtwEnd::closed ? m - 1 : 0; j < m; ++j) {
    offer_end(best, n, j + 1, column[static_cast<std::size_t>(j)]);
  }
  return best;
}

bool all_finite(std::span<const double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// (lanes, m * C) row-major -> (m * C, kDtwLanes). Lanes without a usable series hold zeros.
void pack_lanes(std::span<const double> series, std::size_t lanes, const std::vector<bool>& usable,
                std::vector<double>& packed) {
  const std::size_t size = series.size() / lanes;
  std::fill(packed.begin(), packed.end(), 0.0);
  for (std::size_t l = 0; l < lanes; ++l) {
    if (!usable[l]) continue;
    for (std::size_t k = 0; k < size; ++k) packed[k * kDtwLanes + l] = series[l * size + k];
  }
}

}  // namespace

DtwResult dtw(const Eigen::Ref<const RowMatrix>& recorded,
              const Eigen::Ref<const RowMatrix>& simulated, DtwEnd end) {
  check_series(recorded, simulated.rows(), simulated.cols());
  if (!recorded.allFinite() || !simulated.allFinite()) return {kNaN, kNaN, 0};
  // Copies, so that the kernel may count on dense rows.
  const RowMatrix x = recorded;
  const RowMatrix y = simulated;
  if (y.rows() < x.rows()) return step_along_recorded(x, y, end);
  return step_along_simulated<1>(x, y.data(), y.rows(), end)[0];
}

std::vector<DtwResult> dtw_batch(const Eigen::Ref<const RowMatrix>& recorded,
                                 std::span<const double> simulated, Index num_series, DtwEnd end) {
  if (num_series == 0 && simulated.empty()) return {};
  const Index channels = recorded.cols();
  const auto total = static_cast<Index>(simulated.size());
  if (num_series < 1 || channels < 1 || total % (num_series * channels) != 0) {
    throw ShapeError("dtw_batch: " + std::to_string(total) + " simulated values aren't " +
                     std::to_string(num_series) + " series of " + std::to_string(channels) +
                     " channels");
  }
  const Index m = total / (num_series * channels);
  check_series(recorded, m, channels);
  std::vector<DtwResult> results(static_cast<std::size_t>(num_series), {kNaN, kNaN, 0});
  if (!recorded.allFinite()) return results;
  const RowMatrix x = recorded;
  const auto size = static_cast<std::size_t>(m * channels);
  std::vector<double> packed(size * kDtwLanes);
  for (std::size_t first = 0; first < results.size(); first += kDtwLanes) {
    const std::size_t lanes = std::min<std::size_t>(kDtwLanes, results.size() - first);
    std::vector<bool> usable(lanes);
    for (std::size_t l = 0; l < lanes; ++l) {
      usable[l] = all_finite(simulated.subspan((first + l) * size, size));
    }
    pack_lanes(simulated.subspan(first * size, lanes * size), lanes, usable, packed);
    const auto group = step_along_simulated<kDtwLanes>(x, packed.data(), m, end);
    for (std::size_t l = 0; l < lanes; ++l) {
      if (usable[l]) results[first + l] = group[l];
    }
  }
  return results;
}

}  // namespace npdr::analysis
