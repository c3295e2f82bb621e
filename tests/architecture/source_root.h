/// The folder whose files the tests of this folder look at.
#pragma once

#include <filesystem>

namespace npdr::architecture {

inline const std::filesystem::path kRoot = NPDR_SOURCE_DIR;

}  // namespace npdr::architecture
