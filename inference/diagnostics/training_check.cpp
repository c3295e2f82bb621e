#include "inference/diagnostics/training_check.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace npdr::inference {
namespace {

constexpr double kLargestGap = 1000.0;  // [nats] of a training that hasn't diverged

}  // namespace

TrainingCheck check_training(const Vector& training_loss, const Vector& validation_loss,
                             const TrainingConfig& config) {
  const Index epochs = validation_loss.size();
  if (epochs < 1 || training_loss.size() != epochs) {
    throw InputError("training check: " + std::to_string(training_loss.size()) + " training and " +
                     std::to_string(epochs) + " validation losses, must be as many, at least one");
  }
  TrainingCheck check{.num_epochs = epochs};
  Index best = 0;
  check.validation_loss = validation_loss.minCoeff<Eigen::PropagateNumbers>(&best);
  check.best_epoch = best + 1;
  // The count began before the best epoch where none is better than the weights it began with.
  const bool has_stopped =
      epochs < config.max_epochs || epochs - check.best_epoch >= config.stop_after_epochs;
  const Index before = epochs - std::max<Index>(1, epochs / 10);
  if (before > 0) {
    check.recent_fall =
        validation_loss.head(before).minCoeff<Eigen::PropagateNumbers>() - check.validation_loss;
  }
  check.generalization_gap = check.validation_loss - training_loss(best);
  check.is_converged = has_stopped && std::abs(check.generalization_gap) <= kLargestGap;
  return check;
}

}  // namespace npdr::inference
