#include "pipeline/artefacts/target_file.h"

#include "pipeline/artefacts/feature_file.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"

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
  const bool is_observation = open_artefact(target, kTargetSchema).has("x");
  return is_observation ? read_observation(target.path, {}) : read_recording(target.path);
}

}  // namespace npdr::pipeline
