#include "pipeline/artefacts/transform_file.h"

namespace npdr::pipeline {

void write_transform(h5::File& file, const inference::FeatureTransform& transform) {
  constexpr h5::Storage plain{.chunked = true, .deflate = 1, .rows_per_chunk = 0};
  h5::Group group = file.create_group("transform");
  group.write("mean", transform.mean).label_dimensions({"feature"});
  group.write("inverse_deviation", transform.inverse_deviation).label_dimensions({"feature"});
  if (transform.basis.cols() == 0) return;
  group.write("basis", transform.basis, plain).label_dimensions({"feature", "component"});
}

inference::FeatureTransform read_transform(const h5::File& file, Index features) {
  const h5::Group group = file.group("transform");
  inference::FeatureTransform transform;
  transform.mean = group.read_vector<float>("mean", features, h5::Values::finite);
  const Index width = transform.mean.size();
  transform.inverse_deviation =
      group.read_vector<float>("inverse_deviation", width, h5::Values::finite);
  if (group.has("basis")) {
    transform.basis = group.read_matrix<float>("basis", width, -1, h5::Values::finite);
  }
  return transform;
}

}  // namespace npdr::pipeline
