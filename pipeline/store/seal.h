/// Seals: the line "npdr xxh3-128 <32 digits>\n" behind all bytes of a file, their XXH3-128, so
/// that damage is found before HDF5 sees it. HDF5's own checksums don't cover texts, scalars and
/// lists of variable length, on whose damage its library may crash. It ignores what follows a
/// file's end.
#pragma once

#include <filesystem>

#include "core/error.h"

namespace npdr::pipeline {

/// Appends the seal to a file that is closed. Throws Error, which calls the file `shown_as`.
void seal_file(const std::filesystem::path& path, const std::filesystem::path& shown_as);

/// A file of ours whose bytes aren't those that were written: nothing is lost when it is removed.
/// What can't be read just now is an Error, and no reason to remove anything.
class DamagedFile : public InputError {
 public:
  using InputError::InputError;
};

/// Reads the whole file where it has a seal; false: it has none, as files of earlier versions, or
/// isn't a file. Throws DamagedFile when the seal isn't that of the bytes before it, and Error when
/// they can't be read.
bool has_intact_seal(const std::filesystem::path& path);

/// Whether a file of ours has lost what it held: its bytes don't match its checksum, or its end is
/// missing. Throws Error when it can't be read.
bool is_damaged(const std::filesystem::path& path);

}  // namespace npdr::pipeline
