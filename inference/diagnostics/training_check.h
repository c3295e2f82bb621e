/// Check that training ended because there was nothing left to learn.
#pragma once

#include <string>

#include "core/types.h"
#include "inference/training_config.h"

namespace npdr::inference {

/// End of a training.
struct TrainingCheck {
  Index num_epochs = 0;
  Index best_epoch = 0;  ///< with the smallest validation loss, counted from 1
  /// Stopped after `stop_after_epochs` epochs without a smaller loss, not by `max_epochs`, and the
  /// training loss of the best epoch is a number within 1000 nats of the validation loss: farther
  /// apart are only those of weights that jump about.
  bool is_converged = false;
  double validation_loss = 0.0;     ///< the smallest, in nats
  double generalization_gap = 0.0;  ///< that minus the training loss of the same epoch, in nats
};

/// Checks the losses of each epoch (E), in nats. Throws InputError unless there are as many, at
/// least one.
TrainingCheck check_training(const Vector& training_loss, const Vector& validation_loss,
                             const TrainingConfig& config);

}  // namespace npdr::inference
