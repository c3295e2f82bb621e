/// HDF5 files as typed arrays. The only user of the HDF5 library; its header stays out of this one.
///
/// Errors name the file, the dataset or attribute, what was found and what must be there, or HDF5's
/// own reason. A file that can't be accepted (not HDF5, truncated, another type or shape, a claimed
/// size that it doesn't hold) is an InputError, found before anything big is allocated. A failed
/// write is an Error that says what to do.
///
/// Files aren't locked: artefacts are renamed into place when they are complete and never change
/// afterward.
///
/// Groups and datasets of a new file are valid until it is closed; those of a file that is read
/// keep it open. Not thread-safe: one thread at a time may use this module.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/types.h"
#include "pipeline/store/h5_object.h"

namespace npdr::pipeline::h5 {

/// How a dataset is laid out in its file.
struct Storage {
  bool chunked = true;       ///< in checksummed chunks (fletcher32); false: one plain block
  int deflate = 4;           ///< level for chunks, after shuffling their bytes: 0 (none) to 9
  Index rows_per_chunk = 0;  ///< 0: as many as fit in about 256 KiB
};

class VirtualParts;

/// Whether NaN and infinity may be read.
enum class Values { any, finite };

/// An n-dimensional array; "rows" count its first dimension.
class Dataset : public Object {
 public:
  Dataset(Handle handle, std::string where);

  const Shape& shape() const { return shape_; }
  Index num_rows() const { return shape_.empty() ? 1 : shape_.front(); }
  /// Elements of one row.
  Index row_size() const;
  /// Throws InputError when the elements are of none of our types.
  ElementType type() const;

  /// Throws InputError unless the shape is `expected`.
  void require_shape(const Shape& expected) const;

  /// HDF5's dimension labels: what each dimension counts, such as "row" and "parameter". Throws
  /// ShapeError unless there is one for each dimension.
  void label_dimensions(const std::vector<std::string>& labels);
  /// One for each dimension; "" where there is none.
  std::vector<std::string> dimension_labels() const;

  /// Rows begin to begin + count - 1, count * row_size() values. A number is read as a type that
  /// holds it exactly, or an integer as a double. Throws ShapeError for rows that don't exist.
  template <class T>
  void read_rows(Index begin, Index count, std::span<T> values) const {
    check_rows(begin, count, static_cast<Index>(values.size()));
    read_raw(element_type<T>(), begin, count, values.data());
  }

  template <class T>
  void write_rows(Index begin, Index count, std::span<const T> values) {
    check_rows(begin, count, static_cast<Index>(values.size()));
    write_raw(element_type<T>(), begin, count, values.data());
  }

  /// The files that hold the rows of a virtual dataset; none: it holds them itself. Throws
  /// InputError when one of them isn't there.
  std::vector<std::filesystem::path> part_files() const;

  /// All values.
  template <class T>
  std::vector<T> read() const {
    require_readable(element_type<T>());
    std::vector<T> values(static_cast<std::size_t>(num_rows() * row_size()));
    read_rows<T>(0, num_rows(), values);
    return values;
  }
  std::vector<std::string> read_texts() const;
  void write_texts(const std::vector<std::string>& texts);

  /// Throws InputError for NaN or infinity: says where.
  template <class T>
  void require_finite(std::span<const T> values) const;

  /// Throws InputError unless the elements can be read as `type`, as read_rows() does, and the file
  /// can hold as many as it claims.
  void require_readable(ElementType type) const;

 private:
  void require_stored(Index element_size) const;
  void check_rows(Index begin, Index count, Index num_values) const;
  void read_raw(ElementType type, Index begin, Index count, void* values) const;
  void read_parts(ElementType type, Index begin, Index count, void* values) const;
  void write_raw(ElementType type, Index begin, Index count, const void* values);

  Shape shape_;
  mutable std::optional<ElementType> readable_as_;  // what require_readable() has found already
  mutable std::shared_ptr<VirtualParts> parts_;     // where others hold the rows
};

/// Rows of a dataset in another file that are rows of a virtual dataset.
struct VirtualSource {
  std::string file;  ///< relative to the folder of the file that holds the virtual dataset
  std::string dataset;
  Index num_rows = 0;
};

/// A folder of datasets and groups.
class Group : public Object {
 public:
  Group(Handle handle, std::string file, std::string path);

  /// Names of the datasets and groups in this group, sorted.
  std::vector<std::string> names() const;
  bool has(const std::string& name) const;
  bool is_group(const std::string& name) const;

  /// Throws InputError when there is no such thing, with the nearest name.
  Group group(const std::string& name) const;
  Dataset dataset(const std::string& name) const;

  Group create_group(const std::string& name);
  Dataset create_dataset(const std::string& name, ElementType type, const Shape& shape,
                         const Storage& storage = {});

  /// A dataset whose rows are those of the sources, one after the other, without a copy.
  Dataset create_virtual_dataset(const std::string& name, ElementType type, const Shape& shape,
                                 const std::vector<VirtualSource>& sources);

  template <class T>
  Dataset write(const std::string& name, const RowMatrixX<T>& values, const Storage& storage = {}) {
    return write_as<T>(name, {values.rows(), values.cols()}, values, storage);
  }
  template <class T>
  Dataset write(const std::string& name, const VectorX<T>& values, const Storage& storage = {}) {
    return write_as<T>(name, {values.size()}, values, storage);
  }
  void write_texts(const std::string& name, const std::vector<std::string>& texts);
  void write_text(const std::string& name, const std::string& text);

  /// `rows` and `cols`: -1 for any number.
  template <class T>
  RowMatrixX<T> read_matrix(const std::string& name, Index rows = -1, Index cols = -1,
                            Values allowed = Values::any) const {
    return read_as<RowMatrixX<T>, T>(name, {rows, cols}, allowed);
  }
  template <class T>
  VectorX<T> read_vector(const std::string& name, Index size = -1,
                         Values allowed = Values::any) const {
    return read_as<VectorX<T>, T>(name, {size}, allowed);
  }
  template <class T>
  T read_scalar(const std::string& name, Values allowed = Values::any) const {
    return read_as<RowMatrixX<T>, T>(name, {}, allowed)(0, 0);
  }
  std::vector<std::string> read_texts(const std::string& name) const;
  std::string read_text(const std::string& name) const;

 private:
  std::string path_of(const std::string& name) const;
  std::string where_of(const char* kind, const std::string& name) const;
  std::string lack_of(std::string_view kind, const std::string& name) const;
  template <class Array>
  static std::size_t size_of(const Array& values) {
    return static_cast<std::size_t>(values.size());
  }

  template <class T, class Array>
  Dataset write_as(const std::string& name, const Shape& shape, const Array& values,
                   const Storage& storage) {
    Dataset dataset = create_dataset(name, element_type<T>(), shape, storage);
    dataset.write_rows<T>(0, shape.front(), {values.data(), size_of(values)});
    return dataset;
  }

  template <class Array, class T>
  Array read_as(const std::string& name, const Shape& shape, Values allowed) const {
    const Dataset stored = dataset(name);
    stored.require_shape(shape);
    stored.require_readable(element_type<T>());
    Array values(stored.num_rows(), stored.row_size());
    const std::span<T> all(values.data(), size_of(values));
    stored.read_rows<T>(0, stored.num_rows(), all);
    if constexpr (std::floating_point<T>) {
      if (allowed == Values::finite) stored.require_finite<T>(all);
    }
    return values;
  }

  std::string file_;
  std::string path_;
};

/// An open file and its root group.
class File : public Group {
 public:
  /// A new file in place of an old one. Messages call it `shown_as` when that isn't empty.
  static File create(const std::filesystem::path& path, const std::string& shown_as = "");
  /// An existing file, for reading.
  static File open(const std::filesystem::path& path);

  File(const File&) = delete;
  File& operator=(const File&) = delete;
  File(File&& other) = default;
  File& operator=(File&& other) = delete;
  ~File();

  /// Hands everything to the file system and closes the file, with all that is open in it. Throws
  /// Error when that fails. A new file that isn't closed like this is abandoned as it is.
  void close();

 private:
  File(Handle handle, const std::string& shown_as, bool is_new);

  bool is_new_;
};

}  // namespace npdr::pipeline::h5
