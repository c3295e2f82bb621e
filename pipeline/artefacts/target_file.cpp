#include "pipeline/artefacts/target_file.h"

#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/store/column_labels.h"

namespace npdr::pipeline {

namespace {

void describe(Layout f, RowMatrix x, Target target) {
  f("x", x, {{"1", "row"}, kFeature}, "x_o").columns(target.state_channels);
  f.attribute("source", target.source, "where it comes from");
}

}  // namespace

void write_observation(h5::File& file, const Target& target) {
  describe(Layout::writer(file), target.rollouts.front().states.bottomRows(1), target);
}

void list_observation(Layout f) { describe(f, {}, {}); }

Target read_target_artefact(const ArtefactFile& target) {
  const h5::File file = open_artefact(target, kTargetSchema);
  if (!file.has("x")) return read_rollouts(file);
  const RowMatrix x = file.read_matrix<double>("x", 1, -1, h5::Values::finite);
  const std::vector<Channel> features = column_channels(file.dataset("x"), x.cols());
  if (std::ssize(features) != x.cols()) {
    throw InputError(file.where() + ": dataset 'x' has no labels; rerun stage 'target'");
  }
  return observation_target(features, x.row(0).transpose(), target.path.filename().string());
}

}  // namespace npdr::pipeline
