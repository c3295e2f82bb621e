/// Settings of the training of a density estimator, as a study gives them.
#pragma once

#include "core/types.h"

namespace npdr::inference {

/// Rows that are needed to train, and to validate.
inline constexpr Index kFewestTrainingRows = 2;

/// Defaults were chosen by the losses of fresh simulations of tasks with known posteriors.
struct TrainingConfig {
  double learning_rate = 1e-3;
  Index batch_size = 50;
  double validation_fraction = 0.1;
  Index stop_after_epochs = 20;  ///< epochs without a better validation loss
  Index max_epochs = 5000;
  double clip_norm = 5.0;  ///< largest Euclidean norm of a gradient; longer ones are scaled
  double average_epochs =
      2.0;  ///< memory of the weights' moving average; 0: the weights themselves
};

}  // namespace npdr::inference
