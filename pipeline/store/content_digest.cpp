#include <fmt/format.h>

#include <algorithm>

#include "pipeline/store/artefact.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

using h5::ElementType;

// Rows are hashed in blocks of about this size, so that a file of any size can be digested.
constexpr Index kBlockBytes = 8 << 20;

template <class T>
void add_numbers(Hasher& hasher, const h5::Dataset& dataset) {
  dataset.require_readable(h5::element_type<T>());  // before room for what it claims is made
  const Index row_bytes = std::max<Index>(1, dataset.row_size() * static_cast<Index>(sizeof(T)));
  const Index block_rows = std::max<Index>(1, kBlockBytes / row_bytes);
  std::vector<T> block;
  for (Index begin = 0; begin < dataset.num_rows(); begin += block_rows) {
    const Index count = std::min(block_rows, dataset.num_rows() - begin);
    block.resize(static_cast<std::size_t>(count * dataset.row_size()));
    dataset.read_rows<T>(begin, count, block);
    hasher.add_bytes(block.data(), block.size() * sizeof(T));
  }
}

void add_values(Hasher& hasher, const h5::Dataset& dataset) {
  switch (dataset.type()) {
    case ElementType::f32:
      return add_numbers<float>(hasher, dataset);
    case ElementType::f64:
      return add_numbers<double>(hasher, dataset);
    case ElementType::u8:
      return add_numbers<std::uint8_t>(hasher, dataset);
    case ElementType::i64:
      return add_numbers<std::int64_t>(hasher, dataset);
    case ElementType::text:
      for (const std::string& text : dataset.read_texts()) hasher.add(text);
  }
}

template <class T>
void add_attribute(Hasher& hasher, const h5::Object& object, const std::string& name) {
  const auto values = object.attribute<std::vector<T>>(name);
  hasher.add(static_cast<std::int64_t>(values.size()));
  for (const T& value : values) hasher.add(value);
}

void add_attributes(Hasher& hasher, const h5::Object& object) {
  for (const std::string& name : object.attribute_names()) {
    hasher.add("attribute " + name);
    switch (object.attribute_type(name)) {
      case ElementType::text:
        add_attribute<std::string>(hasher, object, name);
        break;
      case ElementType::f32:
      case ElementType::f64:
        add_attribute<double>(hasher, object, name);
        break;
      case ElementType::u8:
      case ElementType::i64:
        add_attribute<Index>(hasher, object, name);
    }
  }
}

void add_dataset(Hasher& hasher, const h5::Dataset& dataset) {
  hasher.add(static_cast<std::int64_t>(dataset.type()));
  hasher.add(static_cast<std::int64_t>(dataset.shape().size()));
  for (const Index extent : dataset.shape()) hasher.add(extent);
  add_attributes(hasher, dataset);
  add_values(hasher, dataset);
}

// A file whose groups hold each other would never end.
constexpr int kMaxGroups = 1000;

void add_group(Hasher& hasher, const h5::Group& group, int& num_groups) {
  if (++num_groups > kMaxGroups) {
    throw InputError(fmt::format("{}: more than {} groups", group.where(), kMaxGroups));
  }
  add_attributes(hasher, group);
  for (const std::string& name : group.names()) {
    if (group.is_group(name)) {
      const h5::Group member = group.group(name);
      if (is_volatile(member)) continue;
      hasher.add("group " + name);
      add_group(hasher, member, num_groups);
    } else {
      const h5::Dataset member = group.dataset(name);
      if (is_volatile(member)) continue;
      hasher.add("dataset " + name);
      add_dataset(hasher, member);
    }
  }
  hasher.add("end");
}

}  // namespace

std::string content_digest(const std::filesystem::path& path) {
  Hasher hasher;
  int num_groups = 0;
  add_group(hasher, h5::File::open(path), num_groups);
  return hasher.hex();
}

}  // namespace npdr::pipeline
