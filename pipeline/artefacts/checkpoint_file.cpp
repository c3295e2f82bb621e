#include "pipeline/artefacts/checkpoint_file.h"

#include "core/error.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {
namespace {

void describe(Layout f, inference::TrainingState& state) {
  f.attribute("epoch", state.epoch, "epochs that are done");
  f.attribute("epochs_without_improvement", state.epochs_without_improvement, "the last of them");
  f.attribute("best_validation_loss", state.best_validation_loss, "[nats]");
  f.attribute("num_steps", state.adam.num_steps, "of Adam");
  if (f.reads()) {
    if (state.epoch < 0 || state.epochs_without_improvement < 0 || state.adam.num_steps < 0) {
      throw InputError(f.where() + ": counts of epochs and steps must be >= 0; remove this file");
    }
    f.bind("epochs", state.epoch);
  }
  const DatasetOptions fastest{.storage = kFastest};
  const Dims weights = {{"P"}}, epochs = {{"epochs"}};
  f("parameters", state.parameters, weights, "current weights", fastest);
  f("average", state.average, weights, "their moving average", fastest);
  f("best_parameters", state.best_parameters, weights,
    "the average with the smallest validation loss", fastest);
  f("first_moment", state.adam.first_moment, weights, "of Adam", fastest);
  f("second_moment", state.adam.second_moment, weights, "of Adam", fastest);
  f("training_loss", state.training_loss, epochs, "as in the posterior");
  f("validation_loss", state.validation_loss, epochs, "as in the posterior");
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Identity& identity,
                      Checkpoint checkpoint) {
  ArtefactWriter writer(path, kCheckpointSchema, identity);
  writer.add_cost(checkpoint.cost);
  describe(Layout::writer(writer.file()), checkpoint.training);
  writer.finish();
}

Checkpoint read_checkpoint(const ArtefactFile& artefact) {
  const std::optional<h5::File> file = open_artefact_if_there(artefact, kCheckpointSchema);
  if (!file) return {};
  Checkpoint checkpoint{.training = {}, .cost = provenance_of(*file).cost};
  describe(Layout::reader(*file), checkpoint.training);
  return checkpoint;
}

void list_training_checkpoint(Layout f) {
  inference::TrainingState state;
  describe(f, state);
}

}  // namespace npdr::pipeline
