/// Samples of parameters from a file that any program may have written.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/target.h"
#include "core/types.h"

namespace npdr::pipeline {

struct SampleSet {
  std::string where;             ///< the file, and the dataset in it, as messages call it
  std::vector<Channel> columns;  ///< names and units, 1 where none is given; empty: no names
  RowMatrix rows;                ///< (n, D), all finite
};

/// Positions of `count` among `num_rows` rows, ascending: one at random in each of `count` pieces
/// of the same length, so that whatever a file holds one after the other, or in turn, has its
/// share.
std::vector<Index> spread_positions(Index count, Index num_rows, const StreamId& id);

/// `most_rows` rows at spread positions, or all, of dataset `dataset` (N, D) of an HDF5 file, whose
/// attributes 'labels' and 'units' name the columns where it has them, or of a CSV file, with or
/// without a header `label` or `label [unit]`. Throws InputError for a file that is neither,
/// without such a dataset, or with what isn't a finite number in those rows.
SampleSet read_sample_set(const std::filesystem::path& path, const std::string& dataset,
                          Index most_rows, const StreamId& id = {});

/// `second` with its columns in the order of `first`. Throws InputError when names, units or, where
/// one of them has no names, numbers of columns differ.
SampleSet in_order_of(const SampleSet& first, SampleSet second);

}  // namespace npdr::pipeline
