/// NetCDF-4: HDF5 whose axes are shared and named by dimension scales. So netCDF, xarray and ArviZ
/// read it.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "pipeline/store/h5.h"

namespace npdr::pipeline {

/// A group with dimensions of its own. Throws Error where the file can't be written, ShapeError for
/// a dimension that the group hasn't or values that don't fill a variable. Names are used as
/// name_in_netcdf() makes them.
class NetcdfGroup {
 public:
  explicit NetcdfGroup(h5::Group group) : group_(std::move(group)) {}

  h5::Group& attributes() { return group_; }

  /// A dimension, and its coordinates: texts, or numbers of a type that h5.h knows.
  template <class T>
  h5::Dataset& dimension(const std::string& name, const std::vector<T>& coordinates) {
    h5::Dataset& scale = make_scale(name, h5::element_type<T>(), std::ssize(coordinates));
    scale.write(coordinates);
    return scale;
  }

  /// A variable over dimensions that have been made: row-major, one value for each position.
  /// `unit`: "" for none.
  template <class T>
  void variable(const std::string& name, const std::vector<std::string>& dimensions,
                const std::vector<T>& values, const std::string& unit = "") {
    make_variable(name, h5::element_type<T>(), dimensions, unit).write(values);
  }

 private:
  h5::Dataset& make_scale(const std::string& name, h5::ElementType type, Index size);
  h5::Dataset make_variable(const std::string& name, h5::ElementType type,
                            const std::vector<std::string>& dimensions, const std::string& unit);

  h5::Group group_;
  std::map<std::string, h5::Dataset> scales_;
};

/// `name` without what NetCDF allows in no name: '/', control characters, blanks at the end.
std::string name_in_netcdf(const std::string& name);

}  // namespace npdr::pipeline
