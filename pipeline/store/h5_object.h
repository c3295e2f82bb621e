/// Common parts of groups and datasets of HDF5 files: types, an identifier, attributes.
#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

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

  void set_attribute(const std::string& name, double value);
  void set_attribute(const std::string& name, Index value);
  void set_attribute(const std::string& name, const std::string& value);
  void set_attribute(const std::string& name, const std::vector<double>& values);
  void set_attribute(const std::string& name, const std::vector<Index>& values);
  void set_attribute(const std::string& name, const std::vector<std::string>& values);

  /// Throws InputError when the attribute is missing or of none of our types.
  ElementType attribute_type(const std::string& name) const;

  /// T is one of double, Index, std::string and std::vector of one of them. Throws InputError when
  /// the attribute is missing, or holds something else. Texts of fixed and of variable length are
  /// read alike, and so are a value and a list of one; an integer may be read as a double.
  template <class T>
  T attribute(const std::string& name) const;

 protected:
  Object(Handle handle, std::string where) : handle_(std::move(handle)), where_(std::move(where)) {}

  /// Gives up the identifier without closing it.
  std::int64_t release() { return handle_.release(); }

 private:
  Handle handle_;
  std::string where_;
};

}  // namespace npdr::pipeline::h5
