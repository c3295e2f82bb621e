#include "pipeline/store/netcdf.h"

#include <hdf5_hl.h>

#include <algorithm>

#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline {

std::string name_in_netcdf(const std::string& name) {
  std::string result = name;
  std::ranges::replace_if(
      result,
      [](char c) { return c == '/' || (static_cast<unsigned char>(c) < ' ') || c == '\x7f'; }, '_');
  while (result.ends_with(' ')) result.pop_back();
  return result.empty() ? "_" : result;
}

h5::Dataset& NetcdfGroup::make_scale(const std::string& name, h5::ElementType type, Index size) {
  const std::string own = name_in_netcdf(name);
  h5::Dataset scale = group_.create_dataset(own, type, {size}, {.chunked = false});
  h5::written(H5DSset_scale(scale.id(), own.c_str()), scale.where(), "become a dimension");
  return scales_.emplace(name, std::move(scale)).first->second;
}

h5::Dataset NetcdfGroup::make_variable(const std::string& name, h5::ElementType type,
                                       const std::vector<std::string>& dimensions,
                                       const std::string& unit) {
  h5::Shape shape;
  for (const std::string& dimension : dimensions) {
    const auto scale = scales_.find(dimension);
    if (scale == scales_.end()) throw ShapeError(name + ": there is no dimension " + dimension);
    shape.push_back(scale->second.num_rows());
  }
  // A variable of the name of a dimension would be its coordinates.
  const std::string own = name_in_netcdf(name);
  h5::Dataset variable = group_.create_dataset(scales_.contains(own) ? own + "_" : own, type, shape,
                                               {.chunked = !shape.empty()});
  for (unsigned axis = 0; axis < dimensions.size(); ++axis) {
    const h5::Dataset& scale = scales_.at(dimensions[axis]);
    h5::written(H5DSattach_scale(variable.id(), scale.id(), axis), variable.where(),
                "get its dimensions");
  }
  if (!unit.empty()) variable.set_attribute("units", unit);
  return variable;
}

}  // namespace npdr::pipeline
