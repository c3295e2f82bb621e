#include "pipeline/artefacts/checkpoint_file.h"

#include "core/error.h"
#include "pipeline/artefacts/layout_tables.h"
#include "pipeline/artefacts/network_file.h"
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
  f.forget("P");  // networks of a likelihood aren't as large as those of a posterior
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

void describe_epochs(Layout f, Index epochs) {
  f.attribute("epochs", epochs, "that the networks have done, in all");
}

void write_states(Layout f, std::vector<inference::TrainingState>& states) {
  Index epochs = 0;
  for (const inference::TrainingState& state : states) epochs += state.epoch;
  describe_epochs(f, epochs);
  for (Index m = 0; m < std::ssize(states); ++m) {
    inference::TrainingState& state = states[static_cast<std::size_t>(m)];
    if (state.epoch > 0) describe(f.group(group_of_network(m)), state);
  }
}

std::vector<inference::TrainingState> read_states(Layout f) {
  std::vector<inference::TrainingState> states;
  for (const Index m : networks_there(f)) {
    states.resize(static_cast<std::size_t>(m + 1));
    describe(f.group(group_of_network(m)), states.back());
  }
  return states;
}

}  // namespace

void write_checkpoint(const std::filesystem::path& path, const Identity& identity,
                      Checkpoint checkpoint) {
  ArtefactWriter writer(path, kCheckpointSchema, identity);
  writer.add_cost(checkpoint.cost);
  write_states(Layout::writer(writer.file()), checkpoint.trainings);
  writer.finish();
}

Checkpoint read_checkpoint(const ArtefactFile& artefact) {
  const std::optional<h5::File> file = open_artefact_if_there(artefact, kCheckpointSchema);
  if (!file) return {};
  return {.trainings = read_states(Layout::reader(*file)), .cost = provenance_of(*file).cost};
}

void list_training_checkpoint(Layout f) {
  describe_epochs(f, 0);
  inference::TrainingState state;
  describe(f.group(group_of_network(0)), state);
}

}  // namespace npdr::pipeline
