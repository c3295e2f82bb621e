/// Names of the columns of a table in an HDF5 file: attributes `labels` and `units`.
#pragma once

#include <string>
#include <vector>

#include "core/target.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// One text a column; none where the dataset has no such attribute. Throws InputError unless there
/// are `num_columns`, none of them empty or twice.
std::vector<std::string> column_labels(const h5::Dataset& dataset, Index num_columns);

/// Labels with units: those of the attribute `units`, which labels may repeat as `label [unit]`,
/// or, without it, those of such labels; "1" where there is none. Throws InputError as
/// column_labels() does, also for labels that differ in their units alone, and for more or fewer
/// units than labels.
std::vector<Channel> column_channels(const h5::Dataset& dataset, Index num_columns);

/// Sets both attributes. Throws Error when that fails.
void describe_columns(h5::Dataset& dataset, const std::vector<Channel>& columns);

/// The labels alone.
std::vector<std::string> labels_of(const std::vector<Channel>& columns);

/// The first few of a file's names for a message, none of them long.
std::vector<std::string> few_shortened(const std::vector<std::string>& names);

}  // namespace npdr::pipeline
