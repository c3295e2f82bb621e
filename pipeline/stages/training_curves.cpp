#include "pipeline/stages/training_curves.h"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace npdr::pipeline {

inference::TrainingCheck check_training_curves(const PosteriorNotes& notes,
                                               const inference::TrainingConfig& config) {
  std::vector<inference::TrainingCheck> checks;
  const auto check = [&](const TrainingLosses& losses) {
    return inference::check_training(losses.training, losses.validation, config);
  };
  std::ranges::transform(notes.losses, std::back_inserter(checks), check);
  if (notes.pool && notes.pool->powers.likelihood > 0.0) {
    for (const TrainingLosses& losses : notes.likelihood_losses) {
      if (const auto found = check(losses); !found.is_converged) checks.push_back(found);
    }
  }
  const auto is_better = [](const auto& a, const auto& b) {
    return std::tuple(!a.is_converged, a.generalization_gap) <
           std::tuple(!b.is_converged, b.generalization_gap);
  };
  return *std::ranges::max_element(checks, is_better);
}

}  // namespace npdr::pipeline
