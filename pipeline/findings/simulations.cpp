// Checks of what the posterior of the last round predicts, and of the simulations that it has
// learned from.
#include <fmt/format.h>

#include <cmath>

#include "core/text.h"
#include "inference/diagnostics/tail_probability.h"
#include "pipeline/features/failures.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

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
