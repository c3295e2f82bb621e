/// The formats of files that other programs read and write.
#pragma once

#include "core/enum_names.h"

namespace npdr::pipeline {

enum class FileFormat { csv, hdf5 };
constexpr auto enum_table(FileFormat) {
  return std::to_array<EnumRow<FileFormat>>({{FileFormat::csv, "csv"}, {FileFormat::hdf5, "hdf5"}});
}

}  // namespace npdr::pipeline
