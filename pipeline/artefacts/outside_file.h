/// Files that others have made: samples, recordings, datasets, results of programs. Old HDF5 files
/// have no checksums, HDF5 follows a damaged pointer to wherever it leads, and any file may have
/// been made to mislead its reader.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/target.h"
#include "pipeline/process/forked_trial.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// What `read` makes of the open file. A child goes first: throws InputError where it crashes or
/// doesn't come to an end, and what `read` throws.
template <class Read>
auto read_from_outside(const std::filesystem::path& path, const Read& read) {
  try_to_read(path, [&] { read(h5::File::open(path)); });
  return read(h5::File::open(path));
}

/// A dataset whose values lie in the file itself. Throws InputError for one of another file's rows.
h5::Dataset own_dataset(const h5::Group& group, const std::string& name);

/// 0, 1, ..., count - 1.
std::vector<Index> all_columns(Index count);

/// Some columns of rows at some positions, in any order. Throws InputError.
RowMatrix read_rows_at(const h5::Dataset& dataset, std::span<const Index> rows,
                       const std::vector<Index>& columns);

/// Samples of parameters.
struct SampleSet {
  std::string where;             ///< the file, and the dataset in it, as messages call it
  std::vector<Channel> columns;  ///< names and units, 1 where none is given; empty: no names
  RowMatrix rows;                ///< (n, D), all finite
};

/// Positions of `most` among `num_rows` rows, or of all, ascending: one at random in each of as
/// many pieces of the same length, so that whatever a file holds in turn has its share.
std::vector<Index> spread_positions(Index most, Index num_rows, const StreamId& id);

/// Rows at spread positions of dataset `dataset` (N, D) of an HDF5 file, whose attributes 'labels'
/// and 'units' may name the columns, or of a CSV file, with or without a header `label [unit]`.
/// Throws InputError for a file that is neither, and for what isn't finite in those rows.
SampleSet read_sample_set(const std::filesystem::path& path, const std::string& dataset,
                          Index most_rows, const StreamId& id = {});

/// `second` with its columns in the order of `first`. Throws InputError when names, units or, where
/// one of them has no names, numbers of columns differ.
SampleSet in_order_of(const SampleSet& first, SampleSet second);

}  // namespace npdr::pipeline
