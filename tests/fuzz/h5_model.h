/// HDF5 files as values that bytes of a fuzzer change: shapes, types, numbers, texts, what is
/// there. Files remain such that HDF5 reads them, so that readers see what is wrong with them.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "pipeline/store/h5.h"
#include "tests/fuzz/input_bytes.h"

namespace npdr::pipeline {

struct H5Value {
  h5::ElementType type = h5::ElementType::f64;
  h5::Shape shape;
  std::vector<double> numbers;
  std::vector<std::string> texts;  ///< of type text, in place of numbers
  bool is_hollow = false;          ///< a dataset that nothing was written to
};

struct H5Model {
  std::set<std::string> groups;           ///< "a/b"
  std::map<std::string, H5Value> values;  ///< dataset "a/b", attribute "a/b@c", of the file "@c"

  static H5Model of(const std::filesystem::path& file);

  /// Adds a value, and the groups that it stands in.
  void add(const std::string& path, const H5Value& value);
  /// Makes groups of what has attributes, but isn't a dataset.
  void add_groups();
  /// Changes values as the bytes say.
  void edit(InputBytes& bytes);
  /// Replaces the file.
  void write(const std::filesystem::path& file) const;
};

}  // namespace npdr::pipeline
