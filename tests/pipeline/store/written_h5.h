/// HDF5 files that tests write.
#pragma once

#include <filesystem>
#include <numeric>

#include "core/types.h"
#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// Writes a file with what `fill` puts into it; returns its path.
template <class Fill>
std::filesystem::path written_h5(const std::filesystem::path& path, const Fill& fill) {
  h5::File file = h5::File::create(path);
  fill(file);
  file.close();
  return path;
}

/// 0, 1, 2, ... row by row: values that say where they belong.
inline RowMatrix counted(Index rows, Index cols) {
  RowMatrix values(rows, cols);
  std::iota(values.data(), values.data() + values.size(), 0.0);
  return values;
}

}  // namespace npdr::pipeline
