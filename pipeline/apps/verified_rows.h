/// Rows that `npdr verify` looks at, one after the other: a file of any size takes no more memory
/// than a row of it.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "pipeline/apps/verify.h"
#include "pipeline/artefacts/proposal_file.h"
#include "pipeline/store/artefact.h"

namespace npdr::pipeline {

/// Rows that are checked, ascending: as many of all as are asked for.
class PickedRows {
 public:
  PickedRows(Index num_rows, const VerifyOptions& options);

  Index size() const { return size_; }
  Index operator[](Index i) const { return some_.empty() ? i : some_[static_cast<std::size_t>(i)]; }

 private:
  Index size_;
  std::vector<Index> some_;  // empty: all
};

/// One row of a dataset (N, ...). Throws InputError.
template <class T>
RowMatrixX<T> row_of(const h5::Dataset& dataset, Index row) {
  RowMatrixX<T> values(1, dataset.row_size());
  dataset.read_rows<T>(row, 1, {values.data(), static_cast<std::size_t>(values.size())});
  return values;
}

/// The key of an input that an artefact names, which anybody may have written. Throws InputError.
std::string input_key(const std::filesystem::path& path, const ArtefactInfo& info,
                      const std::string& name);

/// A number of a document that counts something; `otherwise` where it isn't there. Throws
/// InputError, or without `otherwise` what the JSON library throws.
Index count_of(const std::filesystem::path& path, const nlohmann::ordered_json& document,
               const std::string& name, std::optional<Index> otherwise = {});

/// The joined file of a shard, or the file itself.
std::filesystem::path simulation_of(const std::filesystem::path& path, const ArtefactInfo& info);

/// Rows of a simulation, or of one of its shards, as they are stored.
class StoredRows {
 public:
  /// Throws InputError.
  StoredRows(const std::filesystem::path& path, const ArtefactInfo& info);

  Index num_rows() const { return values_.num_rows(); }
  /// Of all values.
  const h5::Shape& shape() const { return values_.shape(); }
  Index num_parameters() const { return theta_.row_size(); }
  RowMatrix theta(Index row) const { return row_of<double>(theta_, row); }
  RowMatrixF values(Index row) const { return row_of<float>(values_, row); }
  std::uint8_t status(Index row) const { return row_of<std::uint8_t>(status_, row)(0); }

 private:
  h5::File file_;
  h5::Dataset values_;
  h5::Dataset theta_;
  h5::Dataset status_;
};

/// theta of the same rows as they were proposed: those of a shard are some of its simulation's.
class ProposedRows {
 public:
  /// Throws InputError.
  ProposedRows(const std::filesystem::path& path, const ArtefactInfo& info);

  RowMatrix theta(Index row) const {
    return read_proposal(theta_, {begin_ + row, begin_ + row + 1});
  }

 private:
  h5::Dataset theta_;
  Index begin_;  // the simulation's first row in it
};

}  // namespace npdr::pipeline
