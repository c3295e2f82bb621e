/// Rules where something of the user's takes the place of a built-in simulator. Private to
/// pipeline/config.
#pragma once

#include "pipeline/config/problems.h"
#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Whether the study names exactly one source, as far as its keys could be read.
bool has_source(const Study& study, const Reading& reading);

/// Exactly one of simulator.name, command, worker, library, mjcf and dataset.
void check_source(const Study& study, Reading& reading);

/// Keys that mean nothing to the study's simulator, and what is different where it gives features
/// of x instead of rollouts: names, files, the target, embeddings, rounds, metrics.
void check_source_settings(const Study& study, Reading& reading);

/// Throws InputError where a method wants more rows than the dataset has, or these can't be
/// counted.
void check_dataset_rows(const Study& study, Index num_rows);

/// Gives the parameters of the prior the units that a dataset has for them, in the prior's order;
/// describes them where the study doesn't. Throws InputError where it says another unit, or the
/// dataset one that a study can't have.
void take_units(Study& study, const std::vector<Channel>& parameters);

}  // namespace npdr::pipeline
