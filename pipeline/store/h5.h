/// HDF5 files as typed arrays. The only user of the HDF5 library; its header stays out of this one.
///
/// Errors name the file, the dataset or attribute, what was found and what must be there, or HDF5's
/// own reason. A file that can't be accepted (not HDF5, truncated, another type or shape, a claimed
/// size that it doesn't hold) is an InputError, found before anything big is allocated. A failed
/// write is an Error that says what to do.
///
/// Files aren't locked: artefacts never change after they were renamed into place.
/// Groups and datasets of a new file are valid until it is closed; those of a file that is read
/// keep it open. Not thread-safe.
#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/types.h"

namespace npdr::pipeline::h5 {

/// Numbers of rows, columns, ...; empty for a scalar. In what is expected, -1 stands for any
/// number.
using Shape = std::vector<Index>;

/// "(5, 1251, 4)"; "(any, 4)" for -1.
std::string to_string(const Shape& shape);

enum class ElementType { f32, f64, u8, i64, text };

template <class T>
constexpr ElementType element_type() {
  if constexpr (std::is_same_v<T, float>) return ElementType::f32;
  if constexpr (std::is_same_v<T, double>) return ElementType::f64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return ElementType::u8;
  if constexpr (std::is_same_v<T, std::int64_t>) return ElementType::i64;
  if constexpr (std::is_same_v<T, std::string>) return ElementType::text;
}

/// Owns an identifier of the HDF5 library.
class Handle {
 public:
  Handle() = default;
  explicit Handle(std::int64_t id) : id_(id) {}
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }
  ~Handle();

  std::int64_t id() const { return id_; }
  /// Gives up the identifier without closing it.
  std::int64_t release() { return std::exchange(id_, -1); }

 private:
  std::int64_t id_ = -1;
};

/// A group or a dataset: it can carry attributes.
class Object {
 public:
  /// The file, and the object in it, as messages call it: "theta.h5: dataset 'theta'".
  const std::string& where() const { return where_; }
  std::int64_t id() const { return handle_.id(); }
  /// File and place in it: equal for two names of the same object. Throws InputError.
  std::pair<std::uint64_t, std::uint64_t> identity() const;

  bool has_attribute(const std::string& name) const;
  /// Sorted.
  std::vector<std::string> attribute_names() const;

  /// Throws InputError when the attribute is missing or of none of our types.
  ElementType attribute_type(const std::string& name) const;

  /// T: double, Index, std::string or std::vector of one of them. Throws InputError when the
  /// attribute is missing, or holds something else. A value and a list of one are read alike, and
  /// an integer may be read as a double.
  template <class T>
  T attribute(const std::string& name) const;
  /// In place of an old one of this name. Throws Error.
  template <class T>
  void set_attribute(const std::string& name, const T& value);

 protected:
  Object(Handle handle, std::string where) : handle_(std::move(handle)), where_(std::move(where)) {}

  /// Gives up the identifier without closing it.
  std::int64_t release() { return handle_.release(); }

 private:
  Handle handle_;
  std::string where_;
};

/// How a dataset is laid out in its file.
struct Storage {
  bool chunked = true;  ///< in checksummed chunks (fletcher32); false: one plain block
  int deflate = 4;      ///< level for chunks, after shuffling their bytes: 0 (none) to 9
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

  /// All values. Texts must be in this file itself.
  template <class T>
  std::vector<T> read(Values allowed = Values::any) const {
    if constexpr (element_type<T>() == ElementType::text) {
      return read_texts();
    } else {
      require_readable(element_type<T>());
      std::vector<T> values(static_cast<std::size_t>(num_rows() * row_size()));
      read_rows<T>(0, num_rows(), values);
      if constexpr (std::floating_point<T>) {
        if (allowed == Values::finite) require_finite<T>(values);
      }
      return values;
    }
  }
  template <class T>
  void write(const std::vector<T>& values) {
    if constexpr (element_type<T>() == ElementType::text) {
      write_texts(values);
    } else {
      write_rows<T>(0, num_rows(), values);
    }
  }

  /// Throws InputError for NaN or infinity: says where.
  template <class T>
  void require_finite(std::span<const T> values) const;

  /// Throws InputError unless the elements can be read as `type` and the file can hold as many as
  /// it claims.
  void require_readable(ElementType type) const;

 private:
  std::vector<std::string> read_texts() const;
  void write_texts(const std::vector<std::string>& texts);
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

  template <class T, int Cols, int Order>
  Dataset write(const std::string& name,
                const Eigen::Matrix<T, Eigen::Dynamic, Cols, Order>& values,
                const Storage& storage = {}) {
    static_assert(Cols == 1 || Order == Eigen::RowMajor);
    const Shape shape = Cols == 1 ? Shape{values.rows()} : Shape{values.rows(), values.cols()};
    Dataset dataset = create_dataset(name, element_type<T>(), shape, storage);
    dataset.write_rows<T>(0, values.rows(),
                          {values.data(), static_cast<std::size_t>(values.size())});
    return dataset;
  }
  template <class T>
  Dataset write(const std::string& name, const std::vector<T>& values,
                const Storage& storage = {}) {
    Dataset dataset = create_dataset(name, element_type<T>(), {std::ssize(values)}, storage);
    dataset.write(values);
    return dataset;
  }

  /// `rows` and `cols`: -1 for any number.
  template <class T>
  RowMatrixX<T> read_matrix(const std::string& name, Index rows = -1, Index cols = -1,
                            Values allowed = Values::any) const {
    const Dataset stored = dataset(name);
    stored.require_shape({rows, cols});
    stored.require_readable(element_type<T>());
    RowMatrixX<T> values(stored.num_rows(), stored.row_size());
    const std::span<T> all(values.data(), static_cast<std::size_t>(values.size()));
    stored.read_rows<T>(0, stored.num_rows(), all);
    if constexpr (std::floating_point<T>) {
      if (allowed == Values::finite) stored.require_finite<T>(all);
    }
    return values;
  }

 private:
  std::string path_of(const std::string& name) const;
  std::string where_of(const char* kind, const std::string& name) const;
  std::string lack_of(std::string_view kind, const std::string& name) const;

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
