#include "tests/fuzz/h5_model.h"

#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/constants.h"

namespace npdr::pipeline {
namespace {

using h5::ElementType;
using Json = nlohmann::ordered_json;

constexpr std::array<double, 20> kNumbers = {
    0.0,  1.0,    -1.0,   2.0,       3.0,        255.0,  0.5,    kNaN,   1e9,     1e300,
    1e-9, 0x1p31, 0x1p53, kInfinity, -kInfinity, 5e-324, -1e300, 9.3e18, -9.3e18, 4096.0};
constexpr Index kMostElements = 5000;

Index size_of(const h5::Shape& shape) {
  Index size = 1;
  for (const Index extent : shape) size *= extent;
  return size;
}

bool is_text(const H5Value& value) { return value.type == ElementType::text; }

// As many values as the shape has, of the right kind.
void fit(H5Value& value) {
  if (value.is_hollow) return;
  const auto size = static_cast<std::size_t>(size_of(value.shape));
  const auto repeat = [size](auto& values, const auto& none) {
    if (values.empty()) values.push_back(none);
    const std::size_t before = values.size();
    values.resize(size, none);
    for (std::size_t i = before; i < size; ++i) values[i] = values[i - before];
  };
  if (is_text(value)) {
    repeat(value.texts, std::string());
  } else {
    repeat(value.numbers, 0.0);
  }
}

void reshape(H5Value& value, InputBytes& bytes) {
  if (value.is_hollow) return;
  h5::Shape shape(bytes.below(5));
  for (std::size_t d = 0; d < shape.size(); ++d) {
    const Index before = d < value.shape.size() ? value.shape[d] : 2;
    const std::array extents = {before,   before + 1, std::max<Index>(0, before - 1),
                                Index{0}, Index{1},   Index{2},
                                Index{3}, Index{7}};
    shape[d] = bytes.one_of(extents);
  }
  if (size_of(shape) > kMostElements) return;
  value.shape = shape;
  fit(value);
}

void retype(H5Value& value, InputBytes& bytes) {
  constexpr std::array types = {ElementType::f32, ElementType::f64, ElementType::u8,
                                ElementType::i64, ElementType::text};
  value.type = bytes.one_of(types);
  fit(value);
}

// One JSON value inside of a text becomes another, or goes.
std::string edited_json(const std::string& text, InputBytes& bytes) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_structured() || json.empty()) return bytes.text();
  Json flat = json.flatten();
  const auto at = std::next(flat.begin(), static_cast<std::ptrdiff_t>(bytes.below(flat.size())));
  const std::size_t kind = bytes.below(5);
  if (kind == 0) {
    *at = bytes.one_of(kNumbers);
    if (!std::isfinite(at->get<double>())) *at = nullptr;
  } else if (kind == 1) {
    *at = static_cast<Index>(bytes.byte()) - 3;
  } else if (kind == 2) {
    *at = bytes.text();
  } else if (kind == 3) {
    *at = bytes.one_of(flat);
  } else {
    flat.erase(at);
  }
  return flat.unflatten().dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string edited_text(const std::string& text, InputBytes& bytes) {
  if (bytes.below(3) > 0) return edited_json(text, bytes);
  std::string result = text;
  const std::size_t begin = bytes.below(text.size() + 1);
  const std::size_t length = bytes.byte();
  result.replace(begin, length, bytes.text());
  std::erase(result, '\0');  // no HDF5 text holds one
  return result;
}

void edit_element(H5Value& value, InputBytes& bytes) {
  if (is_text(value) && !value.texts.empty()) {
    std::string& text = bytes.one_of(value.texts);
    text = edited_text(text, bytes);
    std::erase(text, '\0');
  } else if (!value.numbers.empty()) {
    bytes.one_of(value.numbers) = bytes.one_of(kNumbers);
  }
}

void fill(H5Value& value, InputBytes& bytes) {
  std::ranges::fill(value.numbers, bytes.one_of(kNumbers));
}

// A shape that the file doesn't hold.
void hollow(H5Value& value, InputBytes& bytes) {
  constexpr std::array<Index, 3> extents = {1000, 1 << 20, Index{1} << 40};
  if (value.is_hollow) return;
  value.is_hollow = true;
  if (!value.shape.empty()) bytes.one_of(value.shape) = bytes.one_of(extents);
}

template <class T>
std::vector<T> converted(const std::vector<double>& numbers) {
  std::vector<T> values;
  for (const double number : numbers) {
    if constexpr (std::is_integral_v<T>) {
      constexpr double low = static_cast<double>(std::numeric_limits<T>::min());
      constexpr double high = static_cast<double>(std::numeric_limits<T>::max());
      const bool is_inside = number > low && number < high;
      const T outside = number > 0 ? std::numeric_limits<T>::max() : std::numeric_limits<T>::min();
      values.push_back(is_inside ? static_cast<T>(number) : outside);
    } else {
      const double bound = static_cast<double>(std::numeric_limits<T>::max());
      values.push_back(std::abs(number) > bound ? static_cast<T>(std::copysign(kInfinity, number))
                                                : static_cast<T>(number));
    }
  }
  return values;
}

template <class T>
void write_numbers(h5::Dataset& dataset, const H5Value& value) {
  const std::vector<T> values = converted<T>(value.numbers);
  dataset.write_rows<T>(0, dataset.num_rows(), std::span<const T>(values));
}

void write_dataset(h5::Group& group, const std::string& name, const H5Value& value) {
  h5::Dataset dataset = group.create_dataset(name, value.type, value.shape, {.chunked = false});
  if (value.is_hollow || size_of(value.shape) == 0) return;
  if (is_text(value)) return dataset.write(value.texts);
  if (value.type == ElementType::f32) return write_numbers<float>(dataset, value);
  if (value.type == ElementType::f64) return write_numbers<double>(dataset, value);
  if (value.type == ElementType::u8) return write_numbers<std::uint8_t>(dataset, value);
  write_numbers<std::int64_t>(dataset, value);
}

void write_attribute(h5::Object& object, const std::string& name, const H5Value& value) {
  if (is_text(value)) return object.set_attribute(name, value.texts);
  const bool is_float = value.type == ElementType::f32 || value.type == ElementType::f64;
  if (is_float) return object.set_attribute(name, value.numbers);
  object.set_attribute(name, converted<Index>(value.numbers));
}

H5Value value_of(const h5::Dataset& dataset) {
  H5Value value{dataset.type(), dataset.shape(), {}, {}};
  if (is_text(value)) {
    value.texts = dataset.read<std::string>();
  } else if (value.type == ElementType::f32 || value.type == ElementType::f64) {
    value.numbers = dataset.read<double>();
  } else {
    const auto numbers = dataset.read<std::int64_t>();
    value.numbers.assign(numbers.begin(), numbers.end());
  }
  return value;
}

void add_attributes(H5Model& model, const h5::Object& object, const std::string& path) {
  for (const std::string& name : object.attribute_names()) {
    // HDF5's own labels of dimensions are no such values.
    if (name.starts_with("DIMENSION")) continue;
    H5Value value{object.attribute_type(name), {}, {}, {}};
    if (is_text(value)) {
      value.texts = object.attribute<std::vector<std::string>>(name);
    } else {
      value.numbers = object.attribute<std::vector<double>>(name);
    }
    value.shape = {std::max(std::ssize(value.texts), std::ssize(value.numbers))};
    model.values[path + "@" + name] = value;
  }
}

void add_group(H5Model& model, const h5::Group& group, const std::string& path) {
  add_attributes(model, group, path);
  for (const std::string& name : group.names()) {
    const std::string below = path.empty() ? name : path + "/" + name;
    if (group.is_group(name)) {
      model.groups.insert(below);
      add_group(model, group.group(name), below);
    } else {
      const h5::Dataset dataset = group.dataset(name);
      model.values[below] = value_of(dataset);
      add_attributes(model, dataset, below);
    }
  }
}

// "a/b" of "a/b/c"; "" of "a".
std::string parent_of(const std::string& path) {
  const std::size_t end = path.rfind('/');
  return end == std::string::npos ? "" : path.substr(0, end);
}

std::string name_in(const std::string& path) { return path.substr(path.rfind('/') + 1); }

}  // namespace

H5Model H5Model::of(const std::filesystem::path& file) {
  H5Model model;
  add_group(model, h5::File::open(file), "");
  return model;
}

void H5Model::add(const std::string& path, const H5Value& value) {
  values[path] = value;
  fit(values[path]);
  const std::string object = path.substr(0, path.find('@'));
  for (std::string above = parent_of(object); !above.empty(); above = parent_of(above)) {
    groups.insert(above);
  }
}

void H5Model::add_groups() {
  for (const auto& [path, value] : values) {
    const std::string object = path.substr(0, path.find('@'));
    if (values.contains(object)) continue;
    for (std::string at = object; !at.empty(); at = parent_of(at)) groups.insert(at);
  }
}

void H5Model::edit(InputBytes& bytes) {
  using Edit = void (*)(H5Value&, InputBytes&);
  constexpr std::array<Edit, 6> edits = {edit_element, edit_element, reshape, retype, fill, hollow};
  while (!bytes.empty() && !values.empty()) {
    auto& [path, value] = bytes.one_of(values);
    const std::size_t what = bytes.below(edits.size() + 2);
    if (what < edits.size()) {
      edits[what](value, bytes);
    } else if (what == edits.size()) {
      value = H5Value(bytes.one_of(values).second);
    } else {
      values.erase(std::string(path));
    }
  }
}

void H5Model::write(const std::filesystem::path& path) const {
  std::filesystem::remove(path);
  h5::File file = h5::File::create(path);
  std::map<std::string, h5::Group> made;
  const auto group_at = [&](const std::string& at) -> h5::Group& {
    return at.empty() ? static_cast<h5::Group&>(file) : made.at(at);
  };
  for (const std::string& group : groups) {
    made.emplace(group, group_at(parent_of(group)).create_group(name_in(group)));
  }
  for (const auto& [at, value] : values) {
    if (at.find('@') == std::string::npos)
      write_dataset(group_at(parent_of(at)), name_in(at), value);
  }
  for (const auto& [at, value] : values) {
    const std::size_t end = at.find('@');
    if (end == std::string::npos) continue;
    const std::string object = at.substr(0, end), name = at.substr(end + 1);
    if (object.empty() || groups.contains(object)) {
      write_attribute(group_at(object), name, value);
    } else if (values.contains(object)) {
      h5::Dataset dataset = group_at(parent_of(object)).dataset(name_in(object));
      write_attribute(dataset, name, value);
    }
  }
  made.clear();
  file.close();
}

}  // namespace npdr::pipeline
