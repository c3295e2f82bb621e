#include "analysis/ensembles.h"

#include <algorithm>
#include <bit>

#include "core/parallel.h"

namespace npdr::analysis {
namespace {

// States next to each other in a sample's row that are taken at once: two cache lines.
constexpr Index kBlock = 32;
using Block = RowMatrixF;  // (n, kBlock)

void exchange(float* __restrict low, float* __restrict high) {
#pragma omp simd
  for (Index k = 0; k < kBlock; ++k) {
    const float a = low[k], b = high[k];
    low[k] = b < a ? b : a;
    high[k] = b < a ? a : b;
  }
}

// Sorts each column by merge exchange (Batcher 1968; Knuth, "The Art of Computer Programming",
// vol. 3, section 5.2.2, algorithm M): which rows are compared doesn't depend on their values.
void sort_columns(Block& block) {
  const Index n = block.rows();
  const auto top = static_cast<Index>(std::bit_ceil(static_cast<std::size_t>(n)) / 2);
  for (Index p = top; p > 0; p /= 2) {
    Index distance = p, q = top, remainder = 0;
    while (true) {
      for (Index i = 0; i + distance < n; ++i) {
        if ((i & p) == remainder) exchange(&block(i, 0), &block(i + distance, 0));
      }
      if (q == p) break;
      distance = q - p;
      q /= 2;
      remainder = p;
    }
  }
}

Place place_of(const TrajectoryView& simulated, Index k) {
  const Index row = k / simulated.num_states;
  return {row / simulated.num_steps, row % simulated.num_steps, k % simulated.num_states, row};
}

void for_each_block(const TrajectoryView& simulated, const std::vector<Index>& samples,
                    const std::function<void(Block&)>& prepare, const EnsembleBody& body) {
  const Index size = simulated.row_size(), n = std::ssize(samples);
  parallel_for((size + kBlock - 1) / kBlock, [&](Index number) {
    const Index first = number * kBlock, width = std::min(kBlock, size - first);
    Block block = Block::Zero(n, kBlock);
    for (Index i = 0; i < n; ++i) {
      const Index sample = samples[static_cast<std::size_t>(i)];
      std::copy_n(simulated.values.data() + sample * size + first, width, &block(i, 0));
    }
    prepare(block);
    for (Index k = 0; k < width; ++k) {
      Vector ensemble = block.col(k).cast<double>();
      body(place_of(simulated, first + k), {ensemble.data(), samples.size()});
    }
  });
}

}  // namespace

void for_each_ensemble(const TrajectoryView& simulated, const std::vector<Index>& samples,
                       const EnsembleBody& body) {
  for_each_block(
      simulated, samples, [](Block&) {}, body);
}

void for_each_sorted_ensemble(const TrajectoryView& simulated, const std::vector<Index>& samples,
                              const EnsembleBody& body) {
  for_each_block(simulated, samples, sort_columns, body);
}

}  // namespace npdr::analysis
