/// Check that training ended because there was nothing left to learn.
#pragma once

#include <string>

#include "core/types.h"
#include "inference/training_config.h"

namespace npdr::inference {

/// A larger gap means that the network gives what it has learned from e^3 = 20 times the density of
/// what it hasn't. Where both are the same, a validation loss of n rows varies by sqrt(D / 2n): it
/// takes fewer than 2 rows for each parameter to raise a false alarm in one of 10^4 trainings.
inline constexpr double kFarGap = 3.0;  // [nats]

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
  double recent_fall = 0.0;         ///< of the smallest validation loss in the last tenth of epochs

  bool is_far_from_training() const { return generalization_gap > kFarGap; }
  bool passes() const { return is_converged && !is_far_from_training(); }
};

/// Checks the losses of each epoch (E), in nats. Throws InputError unless there are as many, at
/// least one.
TrainingCheck check_training(const Vector& training_loss, const Vector& validation_loss,
                             const TrainingConfig& config);

}  // namespace npdr::inference
