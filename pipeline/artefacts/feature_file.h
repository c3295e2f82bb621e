/// Files that hold feature vectors x, one a row: what a simulator writes, and observations.
///
///   CSV    numbers, a line a row; the first line may name the features, `label` or `label [unit]`
///   HDF5   dataset `x` (n, F), or (F) for one row; its attribute `labels` may name the features
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/feature_names.h"
#include "core/finding.h"
#include "core/target.h"
#include "core/types.h"
#include "pipeline/store/number_table.h"

namespace npdr::pipeline {

struct FeatureRows {
  std::vector<Channel> features;  ///< those expected, or else the file's, or else x0, x1, ...
  RowMatrix x;                    ///< (n, F), NaN and infinities as they stand there
};

/// Content that a file must have.
struct FeatureDemands {
  std::vector<Channel> features;            ///< empty: whatever there is
  NamesFrom names_from = NamesFrom::study;  ///< observation: several columns need names
  bool needs_line_ends = false;  ///< of CSV: of its last line, too, which a cut file lacks
};

/// Reads exactly `num_rows` rows of a file. Columns with names may be in any order. Throws
/// InputError that names the file and what is wrong with it. A child process reads HDF5 first, so
/// no other thread may be using it.
FeatureRows read_features(const std::filesystem::path& path, FileFormat format, Index num_rows,
                          const FeatureDemands& demands);

/// x_o: the only row of a file, CSV by its extension or HDF5, as the state after the only step of a
/// rollout. Throws InputError, also for NaN and infinities.
Target read_observation(const std::filesystem::path& path, const std::vector<Channel>& expected);

/// The same for x_o (F) that is there already; `source` says where it comes from.
Target observation_target(const std::vector<Channel>& features, const Vector& x_o,
                          const std::string& source);

/// Of a file with x_o that, as CSV, doesn't end its last line (number_table.h).
Findings warnings_of_observation(const std::filesystem::path& path);

}  // namespace npdr::pipeline
