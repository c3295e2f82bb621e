#include "pipeline/report/verdict_reasons.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inference/diagnostics/tail_probability.h"
#include "pipeline/features/failures.h"
#include "pipeline/report/verdict_parts.h"

namespace npdr::pipeline {
namespace {

using inference::smallest_tail_probability;

std::string times_usual(const inference::Distance& distance) {
  if (!(distance.observed > 0.0) || std::isinf(distance.observed) || distance.median == 0.0) {
    return "";
  }
  return fmt::format("{:.3g} times", distance.observed / distance.median);
}

// An observation outside of what was simulated makes all else void.
std::string outside_reason(const Study& study, const inference::OutOfDistribution& ood,
                           std::uint64_t seed) {
  std::string distances;
  const auto add = [&](const inference::Distance& distance, const char* what) {
    const std::string times = times_usual(distance);
    if (times.empty()) return;
    distances += fmt::format("{}{} {}", distances.empty() ? "" : ", ", times, what);
  };
  add(ood.mahalanobis, "the usual distance within the simulations' directions");
  add(ood.residual, "that beyond them");
  add(ood.nearest, "that to the nearest simulation");
  if (std::isinf(ood.residual.observed)) {
    distances +=
        (distances.empty() ? "" : ", ") +
        std::string(
            "and a feature that in all of them has another value, or one far farther from 0");
  }
  return fmt::format(
      "the observation lies outside of what was simulated (seed {}: {}); the network extrapolates "
      "there, whatever the other checks say: look at units, clock and conventions of the "
      "recording, widen the prior, or {}",
      seed, distances,
      is_noise_unstated(study) ? "state the noise of its sensors, observation_noise.scale"
                               : "raise observation_noise");
}

std::string unpredicted_reason(const Study& study, const PredictiveResult& predictive,
                               Index num_samples, std::uint64_t seed) {
  if (predictive.median.hasNaN()) {
    return fmt::format(
        "{} of its {} predictions failed (seed {}), too many to compare the others with the "
        "observation; see why in the log of stage diagnose, or in those of its simulations",
        predictive.num_failed, num_samples, seed);
  }
  Index worst = 0;
  predictive.check.summary_p_value.minCoeff(&worst);
  return fmt::format(
      "what its samples predict is unlike the observation (seed {}), most in {}: observed {:.3g}, "
      "predicted median {:.3g}, p = {:.2g} (of all features together p = {:.2g}): simulator or "
      "noise lack something{}, or more simulations find parameters that predict it",
      seed, predictive.names[static_cast<std::size_t>(worst)], predictive.observed(worst),
      predictive.median(worst), predictive.check.summary_p_value(worst),
      predictive.check.overall.p_value, noise_hint(study));
}

constexpr const char* kCalibrationAdvice =
    "more simulations, another embedding, density estimator or algorithm may mend that";

// The area's standard error is 0.32 / sqrt(n); nearer to 0 it says nothing of the width.
std::string coverage_reason(const CoverageResult& result, std::uint64_t seed) {
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
double smallest_fault(Index n, double level) {
  return std::sqrt(std::log(2.0 / level) / (2.0 * static_cast<double>(n)));
}

std::string too_few(const char* what, Index count, const char* advice) {
  return fmt::format("{} {} are too few to find anything; {}", count, what, advice);
}

// More samples don't help a posterior that lies where its simulator fails.
std::string too_few_predictions(Index count, Index num_failed, Index num_samples) {
  const char* const what = "predictions to compare with";
  if (2 * num_failed <= num_samples) return too_few(what, count, "raise diagnose.num_samples");
  return fmt::format("{} of {} samples failed in the simulator; {}", num_failed, num_samples,
                     too_few(what, count, kFailureAdvice));
}

}  // namespace

std::string failure_reason(Check check, const Study& study, const ResultOf<Diagnosis>& run) {
  const Diagnosis& found = run.result;
  const std::uint64_t seed = run.use.seed;
  switch (check) {
    case Check::sbc:
      return fmt::format(
          "ranks of the truth aren't uniform (seed {}): the network's posteriors "
          "are of the wrong place or width; {}",
          seed, kCalibrationAdvice);
    case Check::coverage:
      return coverage_reason(*found.coverage, seed);
    case Check::tarp:
      return coverage_reason(*found.tarp, seed);
    case Check::local_c2st:
      return fmt::format("its samples can be told from those of the true posterior (seed {}); {}",
                         seed, kCalibrationAdvice);
    case Check::predictive:
      return unpredicted_reason(study, *found.predictive, found.num_samples, seed);
    case Check::ood:
      return outside_reason(study, *found.ood, seed);
    case Check::failures:
      return fmt::format("{} (seed {}). {}", words_of(*found.failures), seed, kFailureAdvice);
    default:
      return "";
  }
}

std::string too_little_to_tell(Check check, const Diagnosis& found, double level) {
  constexpr double largest_fault = 0.25;
  const bool of_ranks = check == Check::sbc || check == Check::coverage || check == Check::tarp;
  if (of_ranks && smallest_fault(found.num_simulations, level) > largest_fault) {
    return fmt::format(
        "of {} simulations it finds only credible regions whose probability is wrong by {:.2f} or "
        "more; raise diagnose.num_simulations",
        found.num_simulations, smallest_fault(found.num_simulations, level));
  }
  if (check == Check::ood && !found.ood) {
    return "its good simulations are too few to find anything; raise method.num_simulations";
  }
  if (check == Check::ood && 3.0 * smallest_tail_probability(found.ood->num_reference) >= level) {
    return too_few("simulations to compare with", found.ood->num_reference,
                   "raise method.num_simulations");
  }
  if (check == Check::predictive && !found.predictive->median.hasNaN()) {
    const Index reference = found.predictive->check.overall.num_reference;
    if (6.0 * smallest_tail_probability(reference) >= level) {
      return too_few_predictions(reference, found.predictive->num_failed, found.num_samples);
    }
  }
  return "";
}

std::string training_reason(const DiagnosisRuns& runs, const inference::TrainingConfig& training) {
  for (const auto* run : runs) {
    const inference::TrainingCheck& check = *run->result.training;
    if (check.passes()) continue;
    const bool ended = check.num_epochs >= training.max_epochs;
    // More epochs don't mend what falls no more.
    if (check.is_converged || (ended && check.is_far_from_training() && check.recent_fall <= 0.0)) {
      return fmt::format(
          "the validation loss lies {:.2g} nats above that of training (seed {}): "
          "simulations are too few for so many weights and features; more of them, "
          "or a smaller network",
          check.generalization_gap, run->use.seed);
    }
    if (ended) {
      return fmt::format(
          "it ended at training.max_epochs = {} (seed {}), the validation loss fell "
          "by {:.2g} nats in the last tenth of the epochs; raise it",
          training.max_epochs, run->use.seed, check.recent_fall);
    }
    return fmt::format("weights jump about (seed {}); lower training.learning_rate", run->use.seed);
  }
  return "";
}

}  // namespace npdr::pipeline
