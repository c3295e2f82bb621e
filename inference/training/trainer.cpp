#include "inference/training/trainer.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/constants.h"
#include "core/error.h"
#include "core/flush_subnormals.h"

namespace npdr::inference {
namespace {

struct Split {
  std::vector<std::uint32_t> training;
  std::vector<std::uint32_t> validation;
};

// A batch, or all rows when there are fewer.
std::size_t rows_per_batch(const TrainingConfig& config, const std::vector<std::uint32_t>& rows) {
  return std::min(static_cast<std::size_t>(config.batch_size), rows.size());
}

StreamId of_epoch(StreamId id, std::string_view name, std::uint64_t epoch) {
  id.epoch = epoch;
  return named(id, name);
}

// Every (1 / validation_fraction)-th row validates, from an offset of the seed's. Rows are draws of
// the same distribution, so that is as good as a random choice, and a row keeps its part when later
// rounds add more: nothing validates that an earlier round has trained on.
Split split_rows(Index num_rows, const TrainingConfig& config, const ValidationFold& fold) {
  const double offset = Stream({fold.seed, "validation_split", 0, 0, 0}).uniform() +
                        static_cast<double>(fold.number) * config.validation_fraction;
  const auto validating_before = [&](Index row) {
    return std::floor(offset + config.validation_fraction * static_cast<double>(row));
  };
  Split split;
  for (Index row = 0; row < num_rows; ++row) {
    const Index known = fold.rows.empty() ? row : fold.rows[static_cast<std::size_t>(row)];
    const bool validates = validating_before(known + 1) > validating_before(known);
    (validates ? split.validation : split.training).push_back(static_cast<std::uint32_t>(row));
  }
  const std::size_t fewest = kFewestTrainingRows;
  if (split.training.size() < fewest || split.validation.size() < fewest) {
    throw InputError("training: " + std::to_string(split.training.size()) + " training and " +
                     std::to_string(split.validation.size()) +
                     " validation rows, must be at least " + std::to_string(fewest) +
                     " each; use more simulations");
  }
  return split;
}

void update_average(const TrainingConfig& config, std::size_t steps_per_epoch, TrainingState& state,
                    std::int64_t num_steps) {
  const double memory = config.average_epochs * static_cast<double>(steps_per_epoch);
  const double weight =
      std::max(1.0 / static_cast<double>(num_steps + 1), 1.0 / std::max(memory, 1.0));
  state.average += static_cast<float>(weight) * (state.parameters - state.average);
}

// Every row once, in random order; the rows that don't fill a last batch wait for another epoch.
double train_epoch(Objective& objective, const TrainingConfig& config, const Split& split,
                   const StreamId& id, Adam& optimizer, Parameters<float>& gradient,
                   TrainingState& state) {
  const FlushSubnormals flush;
  const auto epoch = static_cast<std::uint64_t>(state.epoch + 1);
  std::vector<std::uint32_t> rows = split.training;
  const std::size_t batch_size = rows_per_batch(config, rows);
  Stream stream(of_epoch(id, "shuffle", epoch));
  for (std::size_t i = rows.size(); i > 1; --i) {
    std::swap(rows[i - 1], rows[stream.below(static_cast<std::uint32_t>(i))]);
  }
  const std::size_t num_batches = rows.size() / batch_size;
  double sum = 0.0;
  for (std::size_t b = 0; b < num_batches; ++b) {
    const Batch batch{std::span(rows).subspan(b * batch_size, batch_size), epoch, b};
    sum += objective.loss(state.parameters, batch, &gradient);
    optimizer.step(gradient, clip_scale(gradient, config.clip_norm), state.parameters);
    update_average(config, num_batches, state, optimizer.state().num_steps);
  }
  return sum / static_cast<double>(num_batches);
}

// Mean loss over the validation rows; the last batch reaches back so that every batch is full.
double validate(Objective& objective, const TrainingConfig& config, const Split& split,
                const Parameters<float>& parameters) {
  const FlushSubnormals flush;
  const std::size_t batch_size = rows_per_batch(config, split.validation);
  const std::size_t count = split.validation.size();
  double sum = 0.0;
  std::uint64_t number = 0;
  for (std::size_t begin = 0; begin < count; begin += batch_size, ++number) {
    const std::size_t first = std::min(begin, count - batch_size);
    const Batch batch{std::span(split.validation).subspan(first, batch_size), 0, number};
    sum += objective.loss(parameters, batch, nullptr);
  }
  return sum / static_cast<double>(number);
}

void keep_if_best(TrainingState& state, double loss) {
  if (loss < state.best_validation_loss) {
    state.best_validation_loss = loss;
    state.best_parameters = state.average;
    state.epochs_without_improvement = 0;
  } else {
    ++state.epochs_without_improvement;
  }
}

void require_finite_loss(const TrainingState& state) {
  const auto is_finite = [](double loss) { return std::isfinite(loss); };
  const auto& losses = state.validation_loss;
  if (losses.empty() || std::any_of(losses.begin(), losses.end(), is_finite)) return;
  throw Error("training diverged: the validation loss was not finite in any of " +
              std::to_string(losses.size()) +
              " epochs; lower training.learning_rate, or look for extreme values in x");
}

}  // namespace

StreamId of_batch(StreamId id, std::string_view name, const Batch& batch) {
  id.epoch = batch.epoch;
  id.row = batch.number;
  return named(id, name);
}

bool TrainingState::finished(const TrainingConfig& config) const {
  return epoch >= config.max_epochs || epochs_without_improvement >= config.stop_after_epochs;
}

void train(Objective& objective, const TrainingConfig& config, const StreamId& id,
           TrainingState& state, const EpochHook& hook) {
  train(objective, config, id, {id.seed, 0}, state, hook);
}

void train(Objective& objective, const TrainingConfig& config, const StreamId& id,
           const ValidationFold& fold, TrainingState& state, const EpochHook& hook) {
  const Split split = split_rows(objective.num_rows(), config, fold);
  Adam optimizer(state.parameters.size(), config.learning_rate);
  Parameters<float> gradient = Parameters<float>::Zero(state.parameters.size());
  if (state.epoch == 0) {
    // The weights of the round before are the first candidate: training can't end with worse ones.
    state.average = state.parameters;
    state.best_parameters = state.parameters;
    state.best_validation_loss = validate(objective, config, split, state.parameters);
    if (!std::isfinite(state.best_validation_loss)) {
      state.best_validation_loss = kInfinity;
    }
  } else {
    optimizer.set_state(state.adam);
  }
  while (!state.finished(config)) {
    state.training_loss.push_back(
        train_epoch(objective, config, split, id, optimizer, gradient, state));
    state.validation_loss.push_back(validate(objective, config, split, state.average));
    ++state.epoch;
    keep_if_best(state, state.validation_loss.back());
    state.adam = optimizer.state();
    if (!hook(state)) return;
  }
  require_finite_loss(state);
}

}  // namespace npdr::inference
