/// Rows of floats that are written once and then read in any order.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "core/types.h"

namespace npdr::pipeline {

/// Holds (n, width) floats: in memory when they are few, else in an unnamed file that vanishes with
/// the process. Reads of the file go through the system's page cache, so they are fast while memory
/// is free and cost none when it isn't. Reading is thread-safe.
class RowStore {
 public:
  /// `folder`: where the file may be. Throws Error when it can't be made.
  RowStore(Index num_rows, Index width, const std::filesystem::path& folder);
  ~RowStore();
  RowStore(const RowStore&) = delete;
  RowStore& operator=(const RowStore&) = delete;

  Index num_rows() const { return num_rows_; }
  Index width() const { return width_; }

  void write(Index row, std::span<const float> values);
  void read(Index row, std::span<float> values) const;

 private:
  Index num_rows_;
  Index width_;
  std::vector<float> memory_;
  int file_ = -1;
};

}  // namespace npdr::pipeline
