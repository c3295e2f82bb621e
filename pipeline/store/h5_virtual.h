/// Virtual datasets: rows that lie in other files. Private to the files of pipeline/store/h5*.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/store/h5.h"

namespace npdr::pipeline::h5 {

/// Whether a dataset's rows lie in other files.
bool is_virtual(const Object& dataset);

/// Throws InputError unless a virtual dataset's rows lie in files of its own folder, and below.
void check_mapping(const Object& dataset);

/// The parts of a virtual dataset, one of which is open at a time. HDF5 itself keeps all of them
/// open, and what it can't open, because a process may only have so many files, it reads as zeros
/// without a word.
class VirtualParts {
 public:
  /// Throws InputError unless every part is there, is whole, and their rows are those that the
  /// dataset claims, one part after the other.
  explicit VirtualParts(const Dataset& whole);

  /// Rows of a part.
  struct Piece {
    const Dataset& part;  ///< until the next call
    const std::string& file;
    Index begin;
    Index num_rows;
  };
  /// The rows from row `row` of the whole dataset to the end of the part that holds it. Throws
  /// InputError when the part has changed.
  Piece from(Index row);

  /// Throws, when a part can't be read because of `error`, what to do about it: DamagedFile where
  /// it has to be removed, otherwise Error.
  [[noreturn]] void fail(const std::string& part, const InputError& error) const;

 private:
  struct Part {
    std::string file;
    std::string dataset;
    Index begin = 0;      ///< its first row in the whole
    Index num_rows = -1;  ///< not known yet
  };
  Dataset opened(const Part& part) const;

  std::string file_;  ///< name of the whole
  Shape shape_;
  ElementType type_;
  std::vector<Part> parts_;
  std::optional<Dataset> current_;
  std::ptrdiff_t current_number_ = 0;  ///< number of the open part, from 1; 0: none
};

}  // namespace npdr::pipeline::h5
