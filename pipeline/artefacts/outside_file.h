/// HDF5 files that others have made: recordings, datasets, results of programs.
///
/// Files of the format before HDF5 1.10 have no checksums on their metadata, HDF5's reader of
/// variable-length texts follows a damaged pointer to wherever it leads, and any file may have been
/// made to mislead its reader.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

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

}  // namespace npdr::pipeline
