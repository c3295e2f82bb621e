/// Mini-batch training with Adam, a validation split, early stopping and weight averaging.
///
/// An exponential moving average of the weights is what is validated and kept (Polyak and Juditsky
/// 1992, "Acceleration of stochastic approximation by averaging"): Adam's steps of constant length
/// leave the weights jumping around the minimum, their average sits in it. After step t
///   average += max(1 / (t + 1), 1 / n) (weights - average),
/// with n the number of steps in `average_epochs` epochs.
#pragma once

#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "core/random.h"
#include "inference/estimators/parameters.h"
#include "inference/training/adam.h"
#include "inference/training_config.h"

namespace npdr::inference {

/// A batch of rows, and what makes its random numbers unique.
struct Batch {
  std::span<const std::uint32_t> rows;
  std::uint64_t epoch = 0;   ///< counted from 1; 0 for validation
  std::uint64_t number = 0;  ///< of the batch in its epoch
};

/// The stream of a purpose of this batch.
StreamId of_batch(StreamId id, std::string_view name, const Batch& batch);

/// Objective of a training: a loss over rows of a data set. Not thread-safe.
class Objective {
 public:
  virtual ~Objective() = default;
  virtual Index num_rows() const = 0;
  /// Mean loss over the batch; with `gradient` not null also its gradient.
  virtual double loss(const Parameters<float>& parameters, const Batch& batch,
                      Parameters<float>* gradient) = 0;
};

/// Everything that a training run needs to go on from the end of an epoch: a checkpoint.
struct TrainingState {
  Parameters<float> parameters;
  Parameters<float> average;          ///< moving average of `parameters`
  Parameters<float> best_parameters;  ///< the average with the smallest validation loss
  double best_validation_loss = 0.0;
  Adam::State adam;
  Index epoch = 0;  ///< epochs done
  Index epochs_without_improvement = 0;
  std::vector<double> training_loss;    ///< (epoch), mean over the epoch's batches
  std::vector<double> validation_loss;  ///< (epoch)

  bool finished(const TrainingConfig& config) const;
};

/// Called after every epoch; returns false to stop here (the state is a valid checkpoint).
using EpochHook = std::function<bool(const TrainingState&)>;

/// Rows that validate: a share of all of them that begins at random, by the seed, and for fold k so
/// many shares later: folds have no row in common as long as there are shares.
struct ValidationFold {
  std::uint64_t seed = 0;
  Index number = 0;
  /// The number by which each row is known in all rounds; empty: 0, 1, 2, ...
  std::span<const std::uint32_t> rows = {};
};

/// Trains from `state` until early stopping, max_epochs or the hook says so. The split into
/// training and validation rows, the batches and their order are functions of `fold`, `id` and the
/// epoch, so a run that is stopped and continued gives the same bits.
/// A state with epoch 0 and only `parameters` set starts from the beginning.
/// Throws InputError when there are fewer than two training or two validation rows, and Error when
/// no epoch had a finite validation loss: then nothing was learned.
void train(Objective& objective, const TrainingConfig& config, const StreamId& id,
           const ValidationFold& fold, TrainingState& state, const EpochHook& hook);
/// The same with the first fold of the seed of `id`.
void train(Objective& objective, const TrainingConfig& config, const StreamId& id,
           TrainingState& state, const EpochHook& hook);

}  // namespace npdr::inference
