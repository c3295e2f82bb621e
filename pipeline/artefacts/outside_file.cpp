#include "pipeline/artefacts/outside_file.h"

namespace npdr::pipeline {

h5::Dataset own_dataset(const h5::Group& group, const std::string& name) {
  h5::Dataset dataset = group.dataset(name);
  if (dataset.part_files().empty()) return dataset;
  throw InputError(dataset.where() + ": its rows lie in other files, must be in this one");
}

}  // namespace npdr::pipeline
