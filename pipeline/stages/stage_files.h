/// What several stages read from artefacts.
#pragma once

#include <optional>

#include "pipeline/plan/plan.h"
#include "pipeline/store/h5.h"
#include "sim/simulator.h"

namespace npdr::pipeline {

/// All rollouts of a built-in simulator's target domain, those that inference sees and then the
/// held-out ones: the recording, or what the truth does.
Target all_rollouts(const Plan& plan);

/// The target in an artefact: rollouts, or x_o.
Target read_target_artefact(const Node& target);

/// The target domain that `node` needs; `num_rollouts` > 0: only the first ones.
Target read_target(const Plan& plan, const Node& node, Index num_rollouts = 0);

/// The target rollouts that the method of `node` sees: its first ones of each iteration.
Target read_seen_target(const Plan& plan, const Node& node);

/// The rollouts that inference doesn't see, where the study has any.
std::optional<Target> read_held_out(const Plan& plan, const Node& node);

/// theta of the proposal `node`, (N, D) in the order of the prior, and its rows [begin, end).
/// Throws InputError for one that isn't finite.
h5::Dataset open_proposal(const Node& node);
RowMatrix read_proposal(const h5::Dataset& theta, RowRange rows);

/// All P parameters of the simulator: the study's nominal ones, `values` in place of some.
Vector nominal_theta(const Study& study, const sim::SimulatorInfo& info,
                     const std::map<std::string, double>& values);

/// All P parameters of the simulator for theta (n, D) in the order of the study's prior: what isn't
/// in the prior has the study's value, or the nominal one.
RowMatrix complete_theta(const Plan& plan, const sim::SimulatorInfo& info, const RowMatrix& theta);

/// Writes theta (n, D) with the names, units and bounds of the prior as attributes.
void write_theta(h5::Group& group, const Plan& plan, const RowMatrix& theta);
/// The same attributes on a dataset whose columns are the prior's parameters.
void describe_theta(h5::Dataset& dataset, const Plan& plan);

}  // namespace npdr::pipeline
