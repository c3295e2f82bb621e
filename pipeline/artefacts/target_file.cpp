#include "pipeline/artefacts/target_file.h"

#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {

void write_observation(h5::File& file, const Target& target) {
  const RowMatrix x = target.rollouts.front().states.bottomRows(1);
  h5::Dataset dataset = file.write("x", x);
  describe_columns(dataset, target.state_channels);
  dataset.label_dimensions({"row", "feature"});
  file.set_attribute("source", target.source);
}

Target read_target_artefact(const ArtefactFile& target) {
  const h5::File file = open_artefact(target, kTargetSchema);
  if (!file.has("x")) return read_rollouts(file);
  const RowMatrix x = file.read_matrix<double>("x", 1, -1, h5::Values::finite);
  return observation_target(column_channels(file.dataset("x"), x.cols()), x.row(0).transpose(),
                            target.path.filename().string());
}

}  // namespace npdr::pipeline
