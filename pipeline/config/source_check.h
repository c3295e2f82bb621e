/// Rules between a study and its dataset, once that has been read.
#pragma once

#include <vector>

#include "pipeline/config/study.h"

namespace npdr::pipeline {

/// Throws InputError where a method wants more rows than the dataset has, or these can't be
/// counted.
void check_dataset_rows(const Study& study, Index num_rows);

/// Gives the parameters of the prior the units that a dataset has for them, in the prior's order;
/// describes them where the study doesn't. Throws InputError where it says another unit, or the
/// dataset one that a study can't have.
void take_units(Study& study, const std::vector<Channel>& parameters);

}  // namespace npdr::pipeline
