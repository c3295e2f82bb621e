#include "sim/row_batches.h"

#include <algorithm>

#include "core/parallel.h"
#include "sim/batch_integrator.h"

namespace npdr::sim {
namespace {

// Wide enough to share SUNDIALS' cost per step, small enough for the working set (some 15 vectors
// of states and constants) to stay near the processor; measured with bench_sim. Narrower only where
// that keeps more threads busy.
constexpr Index kMinRowsPerBatch = 32;
constexpr Index kMaxRowsPerBatch = 128;

}  // namespace

Index rows_per_batch(Integrator integrator, Index num_rollouts) {
  if (is_adaptive(integrator)) return 1;
  const Index share = num_rollouts / (Index{4} * num_threads());
  return std::clamp(padded_lanes(share), kMinRowsPerBatch, kMaxRowsPerBatch);
}

RowMatrix lanes_of(const Eigen::Ref<const RowMatrix>& rows) {
  RowMatrix lanes(rows.cols(), padded_lanes(rows.rows()));
  for (Index i = 0; i < lanes.cols(); ++i) {
    lanes.col(i) = rows.row(std::min(i, rows.rows() - 1)).transpose();
  }
  return lanes;
}

}  // namespace npdr::sim
