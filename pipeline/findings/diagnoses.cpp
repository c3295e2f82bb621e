// Checks that the stage 'diagnose' made: of networks, of what the posterior of the last round
// predicts, and of the simulations that it has learned from.
#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "inference/diagnostics/tail_probability.h"
#include "pipeline/features/failures.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kCalibrationAdvice =
    "more simulations, another embedding, density estimator or algorithm may mend that";

// The area's standard error is 0.32 / sqrt(n); nearer to 0 it says nothing of the width.
template <std::optional<CoverageResult> Diagnosis::*member>
std::string words_of_coverage(const Study& /*study*/, const Diagnosis& found, std::uint64_t seed) {
  const CoverageResult& result = *(found.*member);
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

std::string words_of_prediction(const Study& study, const Diagnosis& found, std::uint64_t seed) {
  const PredictiveResult& predictive = *found.predictive;
  if (predictive.median.hasNaN()) {
    return fmt::format(
        "{} of its {} predictions failed (seed {}), too many to compare the others with the "
        "observation; see why in the log of stage diagnose, or in those of its simulations",
        predictive.num_failed, found.num_samples, seed);
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

std::string too_few(const std::string& what, Index count, const std::string& advice) {
  return fmt::format("{} {} are too few to find anything; {}", count, what, advice);
}

// More samples don't help a posterior that lies where its simulator fails.
std::string too_few_predictions(const Diagnosis& found, double level) {
  const PredictiveResult& predictive = *found.predictive;
  const Index count = predictive.check.overall.num_reference;
  if (predictive.median.hasNaN() || 6.0 * inference::smallest_tail_probability(count) < level)
    return "";
  const bool most_failed = 2 * predictive.num_failed > found.num_samples;
  return too_few("predictions to compare with", count,
                 most_failed ? "most samples fail in the simulator" : "raise diagnose.num_samples");
}

std::string words_of_distances(const inference::OutOfDistribution& ood) {
  std::vector<std::string> words;
  const auto add = [&](const inference::Distance& distance, const char* what) {
    if (!(distance.observed > 0.0) || std::isinf(distance.observed) || distance.median == 0.0) {
      return;
    }
    words.push_back(fmt::format("{:.3g} times {}", distance.observed / distance.median, what));
  };
  add(ood.mahalanobis, "the usual distance within the simulations' directions");
  add(ood.residual, "that beyond them");
  add(ood.nearest, "that to the nearest simulation");
  if (std::isinf(ood.residual.observed)) {
    words.emplace_back(
        "and a feature that in all of them has another value, or one far farther from 0");
  }
  return join(words);
}

// An observation outside of what was simulated makes all else void.
std::string words_of_outlier(const Study& study, const Diagnosis& found, std::uint64_t seed) {
  return fmt::format(
      "the observation lies outside of what was simulated (seed {}: {}); the network extrapolates "
      "there, whatever the other checks say: look at units, clock and conventions of the "
      "recording, widen the prior, or {}",
      seed, words_of_distances(*found.ood),
      is_noise_unstated(study) ? "state the noise of its sensors, observation_noise.scale"
                               : "raise observation_noise");
}

std::string too_few_simulations(const Diagnosis& found, double level) {
  if (!found.ood) {
    return "its good simulations are too few to find anything; raise method.num_simulations";
  }
  const Index count = found.ood->num_reference;
  if (inference::can_be_outside(count, level)) return "";
  return too_few("simulations to compare with", count, "raise method.num_simulations");
}

std::string words_of_failures(const Study& /*study*/, const Diagnosis& found, std::uint64_t seed) {
  return fmt::format("{} (seed {}). {}", words_of(*found.failures), seed, kFailureAdvice);
}

}  // namespace

template <>
Finding judge<Check::sbc>(const MethodResults& m) {
  return judge_p_value(m, {Check::sbc, words_of_ranks, too_few_ranks});
}

template <>
Finding judge<Check::coverage>(const MethodResults& m) {
  return judge_p_value(m,
                       {Check::coverage, words_of_coverage<&Diagnosis::coverage>, too_few_ranks});
}

template <>
Finding judge<Check::tarp>(const MethodResults& m) {
  return judge_p_value(m, {Check::tarp, words_of_coverage<&Diagnosis::tarp>, too_few_ranks});
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

template <>
Finding judge<Check::predictive>(const MethodResults& m) {
  return judge_p_value(m, {Check::predictive, words_of_prediction, too_few_predictions});
}

template <>
Finding judge<Check::ood>(const MethodResults& m) {
  return judge_p_value(m, {Check::ood, words_of_outlier, too_few_simulations, "x_o lies OUTSIDE"});
}

template <>
Finding judge<Check::failures>(const MethodResults& m) {
  return judge_p_value(
      m,
      {.check = Check::failures, .what = words_of_failures, .failure = "failures DEPEND on them"});
}

}  // namespace npdr::pipeline
