/// Rows as lanes: how a batch of rollouts is cut into what one integrator advances.
#pragma once

#include "core/types.h"
#include "sim/integrator.h"
#include "sim/lanes.h"

namespace npdr::sim {

/// Rows of a batch when there are `num_rollouts` rollouts in all: one for an adaptive integrator,
/// otherwise as many as are fastest. No result depends on it.
Index rows_per_batch(Integrator integrator, Index num_rollouts);

/// (Q, L) from (rows, Q), at least one row; lanes that fill up the last block repeat the last row.
RowMatrix lanes_of(const Eigen::Ref<const RowMatrix>& rows);

}  // namespace npdr::sim
