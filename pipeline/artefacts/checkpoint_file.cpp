#include "pipeline/artefacts/checkpoint_file.h"

#include "core/error.h"
#include "pipeline/artefacts/described_artefact.h"
#include "pipeline/artefacts/network_file.h"

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

}  // namespace

void describe(Layout f, TrainingCheckpoint& checkpoint) {
  std::vector<inference::TrainingState>& states = checkpoint.trainings;
  Index epochs = 0;
  for (const inference::TrainingState& state : states) epochs += state.epoch;
  f.attribute("epochs", epochs, "that the networks have done, in all");
  if (f.lists()) states.resize(1);
  if (f.reads()) {
    for (const Index m : networks_there(f)) states.resize(static_cast<std::size_t>(m + 1));
  }
  for (Index m = 0; m < std::ssize(states); ++m) {
    inference::TrainingState& state = states[static_cast<std::size_t>(m)];
    const std::string group = group_of_network(m);
    const bool is_there = f.writes() ? state.epoch > 0 : !f.those_there({group}).empty();
    if (is_there) describe(f.group(group), state);
  }
}
template struct Artefact<TrainingCheckpoint>;

}  // namespace npdr::pipeline
