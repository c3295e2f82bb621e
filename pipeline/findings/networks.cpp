// Checks of networks: of that of round 1 over fresh simulations of the prior, and of trainings.
#include <fmt/format.h>

#include <cmath>

#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kCalibrationAdvice =
    "more simulations, another embedding, density estimator or algorithm may mend that";

// The area's standard error is 0.32 / sqrt(n); nearer to 0 it says nothing of the width.
std::string words_of_coverage(const CoverageResult& result, std::uint64_t seed) {
  const double area = result.coverage.area;
  const bool has_sign = std::abs(area) > 1.0 / std::sqrt(static_cast<double>(result.levels.size()));
  std::string often = "too often at some levels and too seldom at others";
  std::string fault = "of the wrong place or shape";
  if (has_sign) {
    often = area < 0.0 ? "too seldom" : "too often";
    fault = area < 0.0 ? "too narrow, or beside the truth" : "too wide";
  }
  return fmt::format(
      "credible regions hold the truth of fresh simulations {} (seed {}, area {:+.2f}): "
      "posteriors are {}; {}",
      often, seed, area, fault, kCalibrationAdvice);
}

// The smallest error of a distribution function that Kolmogorov-Smirnov finds in n values.
std::string too_few_ranks(const Diagnosis& found, double level) {
  constexpr double largest_fault = 0.25;
  const double smallest =
      std::sqrt(std::log(2.0 / level) / (2.0 * static_cast<double>(found.num_simulations)));
  if (!(smallest > largest_fault)) return "";
  return fmt::format(
      "of {} simulations it finds only credible regions whose probability is wrong by {:.2f} or "
      "more; raise diagnose.num_simulations",
      found.num_simulations, smallest);
}

std::string words_of_ranks(const Study& /*study*/, const Diagnosis& /*found*/, std::uint64_t seed) {
  return fmt::format(
      "ranks of the truth aren't uniform (seed {}): the network's posteriors are of the wrong "
      "place or width; {}",
      seed, kCalibrationAdvice);
}

std::string words_of_classifier(const Study& /*study*/, const Diagnosis& /*found*/,
                                std::uint64_t seed) {
  return fmt::format("its samples can be told from those of the true posterior (seed {}); {}", seed,
                     kCalibrationAdvice);
}

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
Finding judge<Check::sbc>(const MethodResults& m) {
  return judge_p_value(m, {Check::sbc, words_of_ranks, too_few_ranks});
}

template <>
Finding judge<Check::coverage>(const MethodResults& m) {
  const auto words = [](const Study&, const Diagnosis& found, std::uint64_t seed) {
    return words_of_coverage(*found.coverage, seed);
  };
  return judge_p_value(m, {Check::coverage, words, too_few_ranks});
}

template <>
Finding judge<Check::tarp>(const MethodResults& m) {
  const auto words = [](const Study&, const Diagnosis& found, std::uint64_t seed) {
    return words_of_coverage(*found.tarp, seed);
  };
  return judge_p_value(m, {Check::tarp, words, too_few_ranks});
}

template <>
Finding judge<Check::local_c2st>(const MethodResults& m) {
  return judge_p_value(m, {Check::local_c2st, words_of_classifier});
}

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
