#include <fmt/format.h>

#include <algorithm>

#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

// An attribute opened for reading.
struct Attribute {
  Handle handle;
  Handle type;
  Handle space;
  Shape shape;
  std::string where;

  Attribute(const Object& object, const std::string& name)
      : where(object.where() + ": attribute '" + name + "'") {
    if (!object.has_attribute(name)) throw InputError(where + " is missing");
    handle = opened(H5Aopen(object.id(), name.c_str(), H5P_DEFAULT), where, "be opened");
    type = opened(H5Aget_type(handle.id()), where, "be opened");
    space = opened(H5Aget_space(handle.id()), where, "be opened");
    shape = shape_of(space.id(), where);
  }

  template <class T>
  std::vector<T> values() const {
    constexpr ElementType wanted = element_type<T>();
    if (!can_be_read_as(type.id(), wanted)) {
      throw InputError(fmt::format("{} holds {}, must hold {}", where, h5::describe(type.id()),
                                   h5::describe(wanted)));
    }
    if (size_of(shape) == 0) return {};
    const auto read = [&](hid_t memory, void* data) { return H5Aread(handle.id(), memory, data); };
    if constexpr (wanted == ElementType::text) {
      return read_texts(type.id(), space.id(), size_of(shape), where, read);
    } else {
      std::vector<T> numbers(static_cast<std::size_t>(size_of(shape)));
      if (read(memory_type(wanted).id(), numbers.data()) < 0) fail_reading(where, "be read");
      return numbers;
    }
  }
};

herr_t take_name(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;

template <class T>
void write_attribute(const Object& object, const std::string& name, const Shape& shape,
                     const std::vector<T>& values) {
  constexpr ElementType type = element_type<T>();
  const std::string action = "hold attribute '" + name + "'";
  if (object.has_attribute(name)) {
    written(H5Adelete(object.id(), name.c_str()), object.where(), action);
  }
  const Handle space = make_space(shape), stored = file_type(type);
  const Handle attribute = created(
      H5Acreate2(object.id(), name.c_str(), stored.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
      object.where(), action);
  if (values.empty()) return;  // HDF5 takes no pointer to nothing
  const std::string where = object.where() + ": attribute '" + name + "'";
  if constexpr (type == ElementType::text) {
    write_texts(values, where, [&](hid_t memory, const void* data) {
      return H5Awrite(attribute.id(), memory, data);
    });
  } else {
    written(H5Awrite(attribute.id(), memory_type(type).id(), values.data()), where, "be written");
  }
}

}  // namespace

std::pair<std::uint64_t, std::uint64_t> Object::identity() const {
  H5O_info_t info;
  if (H5Oget_info2(id(), &info, H5O_INFO_BASIC) < 0) fail_reading(where(), "be identified");
  return {info.fileno, info.addr};
}

bool Object::has_attribute(const std::string& name) const {
  return is_true(H5Aexists(id(), name.c_str()), where());
}

std::vector<std::string> Object::attribute_names() const {
  std::vector<std::string> names;
  if (H5Aiterate2(id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, take_name, &names) < 0) {
    fail_reading(where(), "list its attributes");
  }
  std::sort(names.begin(), names.end());
  return names;
}

ElementType Object::attribute_type(const std::string& name) const {
  const Attribute stored(*this, name);
  return our_type(stored.type.id(), stored.where);
}

template <class T>
T Object::attribute(const std::string& name) const {
  const Attribute stored(*this, name);
  if constexpr (is_list<T>) {
    return stored.values<typename T::value_type>();
  } else {
    std::vector<T> values = stored.values<T>();
    if (values.size() == 1) return std::move(values.front());
    throw InputError(fmt::format("{} holds {} values, must hold one", stored.where, values.size()));
  }
}

template <class T>
void Object::set_attribute(const std::string& name, const T& value) {
  if constexpr (is_list<T>) {
    write_attribute(*this, name, {std::ssize(value)}, value);
  } else {
    write_attribute<T>(*this, name, {}, {value});
  }
}

template double Object::attribute(const std::string&) const;
template Index Object::attribute(const std::string&) const;
template std::string Object::attribute(const std::string&) const;
template std::vector<double> Object::attribute(const std::string&) const;
template std::vector<Index> Object::attribute(const std::string&) const;
template std::vector<std::string> Object::attribute(const std::string&) const;
template void Object::set_attribute(const std::string&, const double&);
template void Object::set_attribute(const std::string&, const Index&);
template void Object::set_attribute(const std::string&, const std::string&);
template void Object::set_attribute(const std::string&, const std::vector<double>&);
template void Object::set_attribute(const std::string&, const std::vector<Index>&);
template void Object::set_attribute(const std::string&, const std::vector<std::string>&);

}  // namespace npdr::pipeline::h5
