/// Whether artefacts of a plan, and shards of its simulations, are there, and how many rows failed.
#pragma once

#include <string>
#include <vector>

#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Whether the node's artefact is there and complete. Throws InputError where something else than a
/// file has its name.
bool is_complete(const Plan& plan, const Node& node);

/// Whether everything that `node` needs is complete. Throws as is_complete().
bool has_inputs(const Plan& plan, const Node& node);

/// An artefact, and one of those who use it.
struct UsedNode {
  const Node* node;
  Use use;
};

/// Artefacts of a stage, infer or evaluate, of the last round and iteration and without a fold: one
/// for each method and seed. `methods`: of these alone; empty: of all.
std::vector<UsedNode> last_nodes(const Plan& plan, Stage stage,
                                 const std::vector<std::string>& methods = {});

/// The same of a single method. Throws InputError for several methods, and unless all are complete.
std::vector<UsedNode> last_nodes_of_method(const Plan& plan, Stage stage,
                                           const std::vector<std::string>& methods = {});

/// Links the uses of a complete artefact, and removes the checkpoint and the rows asked for that it
/// may have left behind: the process that made it can have been killed in between. Throws Error.
void settle(const Plan& plan, const Node& node);

/// Throws InputError unless `input`, which `node` needs, is complete: names the command to run. In
/// a batch job waits a minute for it: a network file system may show it late.
void require_input(const Plan& plan, const Node& node, const Node& input);
/// The same for everything that `node` needs.
void require_inputs(const Plan& plan, const Node& node);

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
