/// Finished simulations that inference can be made from without a simulator.
///
///   theta  (N, D) floats, attribute `labels`: the names of its columns, and perhaps `units`
///   x      (N, F) floats, attribute `labels` where its features have names; NaN in failed rows
/// A simulation artefact with an x is such a file, too.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/target.h"
#include "core/types.h"
#include "pipeline/store/h5.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {

/// A dataset, of which rows are read as they are asked for. Not thread-safe.
class DatasetFile {
 public:
  /// `parameters`: columns of theta that are read, in this order; empty: all. `features`: of x.
  /// Throws InputError that names the file and what is wrong with it: shapes, types, labels, a
  /// truncated file. A child process reads it first; no other thread may be using HDF5.
  DatasetFile(const std::filesystem::path& path, const std::vector<std::string>& parameters,
              const std::vector<Channel>& features = {});

  Index num_rows() const { return theta_.num_rows(); }
  /// Those that are read, with the units of theta's columns; "1" where the file has none.
  const std::vector<Channel>& parameters() const { return parameters_; }
  const std::vector<Channel>& features() const { return features_; }

  /// Rows at some positions, in that order, (rows, parameters) and (rows, features). Throws
  /// InputError for a theta that isn't finite.
  RowMatrix theta(std::span<const Index> rows) const;
  RowMatrix x(std::span<const Index> rows) const;

 private:
  DatasetFile(h5::File file, const std::vector<std::string>& parameters,
              const std::vector<Channel>& features);

  h5::File file_;
  h5::Dataset theta_;
  h5::Dataset x_;
  std::vector<Channel> parameters_;
  std::vector<Channel> features_;
  std::vector<Index> theta_columns_;
  std::vector<Index> x_columns_;
};

/// Sizes and names of an imported dataset.
struct DatasetCounts {
  Index num_rows = 0;
  Index num_failed = 0;  ///< rows of x that hold NaN or infinities
  std::vector<Channel> parameters;
  std::vector<Channel> features;
  std::vector<std::string> unended;  ///< files whose last line has no end: perhaps they were cut
};

/// Writes a dataset of two CSV files with as many rows, as a whole or not at all: theta, whose
/// first line names the parameters, and x, whose first line may name the features. Throws
/// InputError with file and line. Memory doesn't grow with the number of rows.
DatasetCounts import_dataset(const std::filesystem::path& theta, const std::filesystem::path& x,
                             const std::filesystem::path& output, const CsvFormat& format = {});

}  // namespace npdr::pipeline
