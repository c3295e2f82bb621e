/// Calls of the HDF5 library that the files of pipeline/store/h5* share. Private to them.
#pragma once

#include <hdf5.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/store/h5.h"

namespace npdr::pipeline::h5 {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

/// Keeps HDF5 from printing its error stack, from closing files at the end of the process, which
/// crashes when one of them can't be written, and from following links to other files.
void prepare();

/// Throws Error when HDF5 failed to close a file before: any further call might crash.
void require_sound();

/// HDF5's reason for the last failure: the innermost entry of its error stack.
std::string reason();

/// Throws "where: can't action: HDF5's reason", and what to do about it: Error when a call of the
/// system failed, InputError when reading fails otherwise.
[[noreturn]] void fail_reading(const std::string& where, const std::string& action);
[[noreturn]] void fail_writing(const std::string& where, const std::string& action);

/// The identifier that a call returned, owned; throws when it is invalid.
Handle opened(hid_t id, const std::string& where, const std::string& action);
Handle created(hid_t id, const std::string& where, const std::string& action);
/// HDF5's answer to whether something is there. Throws Error when it couldn't read that.
bool is_true(int answer, const std::string& where);
/// Throws when a write returned a failure.
void written(herr_t status, const std::string& where, const std::string& action);

/// How a dataset was created to be stored.
Handle properties_of(const Object& dataset);

/// The type of elements in memory, and in files: little endian; texts of variable length in UTF-8.
Handle memory_type(ElementType type);
Handle file_type(ElementType type);
/// "64-bit floats", "compound records": what a message calls the elements of a stored type.
std::string describe(hid_t stored);
std::string describe(ElementType type);
/// True when every value of the stored type is a value of `type`.
bool fits(hid_t stored, ElementType type);
/// The same, or integers where doubles are wanted. Beyond 2^53 they are rounded.
bool can_be_read_as(hid_t stored, ElementType type);

/// The smallest of our types that holds a stored type's values; throws InputError when none does.
ElementType our_type(hid_t stored, const std::string& where);

/// The shape of a dataspace; throws InputError for one without, and for absurd sizes.
Shape shape_of(hid_t space, const std::string& where);
/// A dataspace of that shape, of a scalar when it is empty.
Handle make_space(const Shape& shape);
/// Selects rows begin to begin + count - 1 of `space`; returns a dataspace of their shape.
Handle select_rows(hid_t space, const Shape& shape, Index begin, Index count);
/// Number of elements.
Index size_of(const Shape& shape);

/// Reads into a buffer of the given memory type: H5Aread or H5Dread with all but these bound.
using RawRead = std::function<herr_t(hid_t memory_type, void* buffer)>;
using RawWrite = std::function<herr_t(hid_t memory_type, const void* buffer)>;

/// `count` texts of fixed or variable length; `space` is the dataspace that they fill.
std::vector<std::string> read_texts(hid_t stored_type, hid_t space, Index count,
                                    const std::string& where, const RawRead& read);
/// Throws Error for a text with a NUL character, which HDF5 would cut.
void write_texts(const std::vector<std::string>& texts, const std::string& where,
                 const RawWrite& write);

/// Whether a dataset's rows lie in other files.
bool is_virtual(const Object& dataset);

/// Throws InputError unless a virtual dataset's rows lie in files of its own folder, and below.
void check_mapping(const Object& dataset);

/// The parts of a virtual dataset, one of which is open at a time. HDF5 itself opens all of them,
/// and reads zeros where a process may have no more files.
class VirtualParts {
 public:
  /// Throws InputError unless all parts are there, whole, and have the dataset's rows in order.
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
