// Whether networks have learned what their simulations have to say.
#include <fmt/format.h>

#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

// Of a training that didn't end well.
std::string words_of(const inference::TrainingCheck& check, const inference::TrainingConfig& config,
                     std::uint64_t seed) {
  const bool ended = check.num_epochs >= config.max_epochs;
  // More epochs don't mend what falls no more.
  if (check.is_converged || (ended && check.is_far_from_training() && check.recent_fall <= 0.0)) {
    return fmt::format(
        "the validation loss lies {:.2g} nats above that of training (seed {}): simulations are "
        "too few for so many weights and features; more of them, or a smaller network",
        check.generalization_gap, seed);
  }
  if (ended) {
    return fmt::format(
        "it ended at training.max_epochs = {} (seed {}), the validation loss fell by {:.2g} nats "
        "in the last tenth of the epochs; raise it",
        config.max_epochs, seed, check.recent_fall);
  }
  return fmt::format("weights jump about (seed {}); lower training.learning_rate", seed);
}

}  // namespace

template <>
Finding judge<Check::training>(const MethodResults& m) {
  Index failed = 0, far = 0;
  const std::size_t all = m.diagnoses.size();
  double gap = 0.0;
  std::string what;
  for (const auto* run : m.diagnoses) {
    const inference::TrainingCheck& check = *run->result.training;
    failed += check.is_converged ? 0 : 1;
    far += check.is_far_from_training() ? 1 : 0;
    gap += check.generalization_gap / static_cast<double>(all);
    if (what.empty() && !check.passes()) what = words_of(check, m.method.training, run->use.seed);
  }
  std::string text = failed > 0 ? "NOT converged" + seeds_text(failed, all) : "converged";
  text += fmt::format(", gap {:.2g} nats", gap);
  if (far > 0) text += ": FAR above training" + seeds_text(far, all);
  if (failed + far > 0) return fails(text, what);
  return {.severity = Severity::fine, .what = what, .evidence = text};
}

}  // namespace npdr::pipeline
