/// Simulation artefacts: shards, and the file that joins them.
///
///   theta         (N, D) float64, attributes labels, units, prior_lower, prior_upper
///   trajectories  (N, H, T', C) float32: the states after every store_every-th step; NaN for a row
///                 that failed; attributes labels, units, dt, store_every
///   x             (N, F) float32, in their place where the simulator gives features; NaN for a row
///                 that failed; attributes labels, units
///   status        (N) uint8: RolloutStatus; attribute meaning
///   seconds       (N) float32: time that the row took (volatile)
///   shards        group, of the joined file only: who made which rows (volatile; shard_ledger.h)
/// A shard holds a range of rows. The joined file holds the trajectories as a virtual dataset over
/// the shards, and copies of the rest.
#pragma once

#include <vector>

#include "pipeline/plan/plan.h"
#include "pipeline/store/h5.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// The dataset of a simulation that holds what was simulated: trajectories, or x.
h5::Dataset simulated_values(const h5::File& file);

/// Makes the empty datasets of `num_rows` rows.
void create_simulation_datasets(h5::File& file, const Plan& plan, const Target& target,
                                Index num_rows);

std::vector<std::uint8_t> as_bytes(const std::vector<sim::RolloutStatus>& status);

/// What the shard of these rows is.
Identity shard_identity(const Node& node, RowRange rows);

/// Numbers of the shards that aren't there yet.
std::vector<Index> missing_shards(const Plan& plan, const Node& node);

/// Throws InputError unless the simulation `node` has a shard of this number.
void require_shard(const Plan& plan, const Node& node, Index number);

/// Joins the shards, all of which are there.
void join_shards(const Plan& plan, const Node& node, const Target& target);

/// Says that more rows of the joined `simulation` failed than the study's limit allows; empty: not
/// so many.
std::string too_many_failed(const Plan& plan, const Node& node, const h5::File& simulation);

/// Throws FailedRolloutsError when more rows failed than the study's limit allows.
void check_failed_rows(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
