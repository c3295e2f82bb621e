/// The shards of a plan's simulations: which there are, which are missing, how many rows failed.
#pragma once

#include <vector>

#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// All shards of the simulation `node`, there or not.
std::vector<Shard> shards(const Plan& plan, const Node& node);

/// How many those are.
Index num_shards(const Plan& plan, const Node& node);

/// Numbers of the shards that aren't there yet.
std::vector<Index> missing_shards(const Plan& plan, const Node& node);

/// Throws InputError unless the simulation `node` has a shard of this number.
void require_shard(const Plan& plan, const Node& node, Index number);

/// Says that more rows of the joined `simulation` failed than the study's limit allows; empty: not
/// so many. Throws InputError for a damaged one.
std::string too_many_failed(const Plan& plan, const Node& node, const h5::File& simulation);

/// Opens the joined simulation `node`. Throws InputError for a damaged one, FailedRolloutsError
/// when more rows failed than the study's limit allows.
h5::File open_simulation(const Plan& plan, const Node& node);

}  // namespace npdr::pipeline
