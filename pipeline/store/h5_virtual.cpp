#include <filesystem>
#include <functional>

#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

std::vector<hsize_t> extents(const Shape& shape, Index num_rows) {
  std::vector<hsize_t> result(shape.begin(), shape.end());
  result.front() = static_cast<hsize_t>(num_rows);
  return result;
}

Handle space_of(const std::vector<hsize_t>& size, const std::string& where) {
  return created(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), where,
                 "make a dataspace");
}

// A text that an HDF5 call fills in: first its length, then itself.
std::string text_of(const std::function<ssize_t(char*, std::size_t)>& call) {
  const ssize_t length = call(nullptr, 0);
  if (length <= 0) return "";
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  call(text.data(), text.size());
  text.pop_back();
  return text;
}

std::filesystem::path folder_of(const Dataset& dataset) {
  const std::filesystem::path file =
      text_of([&](char* text, std::size_t size) { return H5Fget_name(dataset.id(), text, size); });
  return std::filesystem::canonical(file).parent_path();
}

}  // namespace

bool is_virtual(const Dataset& dataset) {
  const Handle properties = opened(H5Dget_create_plist(dataset.id()), dataset.where(), "read it");
  return H5Pget_layout(properties.id()) == H5D_VIRTUAL;
}

void require_virtual_sources(const Dataset& dataset) {
  const Handle properties = opened(H5Dget_create_plist(dataset.id()), dataset.where(), "read it");
  std::size_t count = 0;
  H5Pget_virtual_count(properties.id(), &count);
  Index num_rows = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::string file = text_of([&](char* text, std::size_t size) {
      return H5Pget_virtual_filename(properties.id(), i, text, size);
    });
    const std::string name = text_of([&](char* text, std::size_t size) {
      return H5Pget_virtual_dsetname(properties.id(), i, text, size);
    });
    const std::filesystem::path path = folder_of(dataset) / file;
    if (!std::filesystem::exists(path)) {
      throw InputError(dataset.where() + ": its part '" + path.string() +
                       "' is missing; remove the joined file and rerun stage 'simulate'");
    }
    const File part = File::open(path);
    const Dataset source = part.dataset(name);
    Shape expected = dataset.shape();
    expected.front() = -1;
    source.require_shape(expected);
    source.require_readable(dataset.type());
    num_rows += source.num_rows();
  }
  if (num_rows == dataset.num_rows()) return;
  throw InputError(dataset.where() + ": its parts hold " + std::to_string(num_rows) +
                   " rows, it claims " + std::to_string(dataset.num_rows()));
}

Dataset Group::create_virtual_dataset(const std::string& name, ElementType type, const Shape& shape,
                                      const std::vector<VirtualSource>& sources) {
  const std::string where =
      file_ + ": dataset '" + (path_.empty() ? name : path_ + "/" + name) + "'";
  const Handle properties = created(H5Pcreate(H5P_DATASET_CREATE), where, "make a virtual dataset");
  H5Pset_obj_track_times(properties.id(), false);
  const Handle space = space_of(extents(shape, shape.front()), where);
  std::vector<hsize_t> start(shape.size(), 0);
  for (const VirtualSource& source : sources) {
    const std::vector<hsize_t> size = extents(shape, source.num_rows);
    const Handle source_space = space_of(size, where);
    written(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(),
                                nullptr),
            where, "select rows");
    written(H5Pset_virtual(properties.id(), space.id(), source.file.c_str(), source.dataset.c_str(),
                           source_space.id()),
            where, "map rows of '" + source.file + "'");
    start.front() += size.front();
  }
  const Handle whole = space_of(extents(shape, shape.front()), where);
  const Handle stored = file_type(type);
  return {created(H5Dcreate2(id(), name.c_str(), stored.id(), whole.id(), H5P_DEFAULT,
                             properties.id(), H5P_DEFAULT),
                  where, "make it"),
          where};
}

}  // namespace npdr::pipeline::h5
