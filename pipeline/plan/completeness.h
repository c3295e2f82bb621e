/// Whether artefacts of a plan are there.
#pragma once

#include <string>
#include <vector>

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

}  // namespace npdr::pipeline
