/// How far stored simulations are from the target, by a metric of trajectories.
#pragma once

#include "core/target.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// RMSE or DTW (analysis/metrics.h) of every row of the simulation `node` against
/// `target`, (N); infinite for those that failed. Compared are the states that were stored, every
/// store_every-th, without observation noise on either side. Reads the rows in blocks, so memory
/// doesn't grow with their number; the same bits on any number of threads.
Vector metric_distances(const Plan& plan, const Node& node, const Target& target,
                        inference::AbcDistance metric);

}  // namespace npdr::pipeline
