/// Calls of the HDF5 library that the files of pipeline/store/h5* share. Private to them.
#pragma once

#include <hdf5.h>

#include <functional>
#include <string>
#include <vector>

#include "pipeline/store/h5.h"

namespace npdr::pipeline::h5 {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

/// Begins every use of a file: keeps HDF5 from printing its error stack, which the messages of this
/// module quote, from closing files at the end of the process, which crashes when one of them can't
/// be written, and from following links to other files, which whoever made a file chose.
void prepare();

/// Throws Error when HDF5 failed to close a file before: any further call might crash.
void require_sound();

/// HDF5's reason for the last failure: the innermost entry of its error stack.
std::string reason();

/// Throws "where: can't action: HDF5's reason", and what to do about it: when a call of the system
/// failed Error, and when reading fails otherwise, because of what the file holds, InputError.
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
/// The same, or integers where doubles are wanted: programs that count write them. Beyond 2^53 they
/// are rounded.
bool can_be_read_as(hid_t stored, ElementType type);

/// The smallest of our types that holds a stored type's values; throws InputError when none does.
ElementType our_type(hid_t stored, const std::string& where);

/// The shape of a dataspace; throws InputError for one without, and for absurd sizes.
Shape shape_of(hid_t space, const std::string& where);
/// A dataspace of that shape, of a scalar when it is empty.
Handle make_space(const Shape& shape);
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

}  // namespace npdr::pipeline::h5
