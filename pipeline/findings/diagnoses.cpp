// Checks that the stage 'diagnose' made: of networks, of what the posterior of the last round
// predicts, and of the simulations that it has learned from.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "inference/diagnostics/excess_width.h"
#include "inference/diagnostics/tail_probability.h"
#include "pipeline/features/failures.h"
#include "pipeline/findings/probe.h"

namespace npdr::pipeline {
namespace {

constexpr const char* kCalibrationAdvice = "Raise num_simulations in [[method]]";

// The area's standard error is 0.32 / sqrt(n); nearer to 0 it says nothing of the width.
template <std::optional<CoverageResult> Diagnosis::*member>
Finding words_of_coverage(const Study& /*study*/, const Diagnosis& found, std::uint64_t seed) {
  const CoverageResult& result = *(found.*member);
  const double area = result.coverage.area;
  const bool has_sign = std::abs(area) > 1.0 / std::sqrt(static_cast<double>(result.levels.size()));
  const char* fault = area < 0.0 ? "too narrow" : "too wide";
  return {
      .what = fmt::format("the error bars are {} (seed {})",
                          has_sign ? fault : "too wide at some levels, too narrow at others", seed),
      .evidence = fmt::format("area {:+.2f} (right: 0)", area),
      .advice = kCalibrationAdvice};
}

// The smallest error of a distribution function that Kolmogorov-Smirnov finds in n values.
Finding too_few_ranks(const Diagnosis& found, double level) {
  constexpr double largest_fault = 0.25;
  const double smallest =
      std::sqrt(std::log(2.0 / level) / (2.0 * static_cast<double>(found.num_simulations)));
  if (!(smallest > largest_fault)) return {};
  return {.what = fmt::format("{} simulations are too few to judge error bars by",
                              found.num_simulations),
          .evidence = fmt::format("only probabilities that are wrong by {:.2f} are noticed "
                                  "(enough: {:.2f})",
                                  smallest, largest_fault),
          .advice = "Raise num_simulations in [diagnose]"};
}

Finding words_of_ranks(const Study& /*study*/, const Diagnosis& /*found*/, std::uint64_t seed) {
  return {.what = fmt::format("in simulated tests error bars are at the wrong place or of the "
                              "wrong width (seed {})",
                              seed),
          .advice = kCalibrationAdvice};
}

Finding words_of_classifier(const Study& /*study*/, const Diagnosis& /*found*/,
                            std::uint64_t seed) {
  return {
      .what = fmt::format("the posterior of the observation is not the true one (seed {})", seed),
      .advice = kCalibrationAdvice};
}

// Of a training that didn't end well.
Finding words_of(const inference::TrainingCheck& check, const inference::TrainingConfig& config,
                 std::uint64_t seed) {
  const bool ended = check.num_epochs >= config.max_epochs;
  // More epochs don't mend what falls no more.
  if (check.is_converged || (ended && check.is_far_from_training() && check.recent_fall <= 0.0)) {
    return {.id = "gap",
            .what = fmt::format("the network knows its simulations by heart, which is overfitting "
                                "(seed {})",
                                seed),
            .evidence = fmt::format("validation loss {:.2g} nats above that of training (fine up "
                                    "to {:.2g})",
                                    check.generalization_gap, inference::kFarGap),
            .advice = kCalibrationAdvice};
  }
  if (ended) {
    return {
        .id = "unfinished",
        .what =
            fmt::format("training reached its limit of epochs before it converged (seed {})", seed),
        .evidence = fmt::format("{} epochs (fine: fewer), the loss still fell by {:.2g} nats in "
                                "the last tenth",
                                config.max_epochs, check.recent_fall),
        .advice = fmt::format("Set max_epochs = {} in [method.training]", 2 * config.max_epochs)};
  }
  return {.id = "unfinished",
          .what = fmt::format("the network's weights jump about (seed {})", seed),
          .evidence = fmt::format("losses of validation and training {:.2g} nats apart (fine up to "
                                  "{:.2g})",
                                  check.generalization_gap, inference::kFarGap),
          .advice = "Lower learning_rate in [method.training]"};
}

// "603.41 on average (observed 603.52)": with as many digits as the difference needs.
std::string words_of_difference(double median, double observed) {
  constexpr double least = 1e-12;
  const double size = std::max(std::abs(median), std::abs(observed));
  const double difference = std::max(std::abs(median - observed), least * size);
  const int more =
      size > 0.0 && std::isfinite(size) ? static_cast<int>(std::log10(size / difference)) : 0;
  return fmt::format("{:.{}g} on average (observed {:.{}g})", median, 3 + more, observed, 3 + more);
}

Finding words_of_prediction(const Study& study, const Diagnosis& found, std::uint64_t seed) {
  const PredictiveResult& predictive = *found.predictive;
  if (predictive.median.hasNaN()) {
    return {.id = "failed",
            .what = fmt::format("too many samples fail in the simulator (seed {})", seed),
            .evidence = fmt::format("{} of {} predictions failed", predictive.num_failed,
                                    found.num_samples),
            .advice = "Read why in the log of stage diagnose"};
  }
  Index worst = 0;
  predictive.check.summary_p_value.minCoeff(&worst);
  return {.what = fmt::format("simulations of the samples are unlike the observation, most in {} "
                              "(seed {})",
                              predictive.names[static_cast<std::size_t>(worst)], seed),
          .evidence = words_of_difference(predictive.median(worst), predictive.observed(worst)),
          .advice = advice_on_noise(study, advice_on_model(study))};
}

// More samples don't help a posterior that lies where its simulator fails.
Finding too_few_predictions(const Diagnosis& found, double level) {
  const PredictiveResult& predictive = *found.predictive;
  const Index count = predictive.check.overall.num_reference;
  if (predictive.median.hasNaN() || 6.0 * inference::smallest_tail_probability(count) < level) {
    return {};
  }
  const bool most_failed = 2 * predictive.num_failed > found.num_samples;
  return {.what = fmt::format("{} predictions are too few to find anything", count),
          .evidence = fmt::format("{} of {} samples failed in the simulator", predictive.num_failed,
                                  found.num_samples),
          .advice = most_failed ? "Read why samples fail in the log of stage diagnose"
                                : "Raise num_samples in [diagnose]"};
}

// How far an observation is from simulations, by the distance that is farthest from the usual one.
std::string words_of_distances(const inference::OutOfDistribution& ood) {
  if (std::isinf(ood.residual.observed)) return "a feature has a value that no simulation is near";
  double largest = 0.0;
  for (const auto& distance : {ood.mahalanobis, ood.residual, ood.nearest}) {
    const double times = distance.observed / distance.median;
    if (std::isfinite(times)) largest = std::max(largest, times);
    if (distance.median == 0.0 && distance.observed > 0.0) {
      return "simulations are all alike there, and it is not";
    }
  }
  return fmt::format("{:.3g} times as far as simulations are (usual: 1)", largest);
}

// An observation outside of what was simulated makes all else void.
Finding words_of_outlier(const Study& study, const Diagnosis& found, std::uint64_t seed) {
  return {
      .what = fmt::format("no simulation is like the observation, so that the result is a guess "
                          "(seed {})",
                          seed),
      .evidence = words_of_distances(*found.ood),
      .advice = advice_on_noise(study, "Check units, clock and signs of the observation")};
}

Finding too_few_simulations(const Diagnosis& found, double level) {
  const Index count = found.ood ? found.ood->num_reference : 0;
  if (found.ood && inference::can_be_outside(count, level)) return {};
  return {.what = "there are too few simulations to compare with the observation",
          .evidence = found.ood ? fmt::format("{} simulations", count) : "",
          .advice = "Raise num_simulations in [[method]]"};
}

Finding words_of_failures(const Study& /*study*/, const Diagnosis& found, std::uint64_t seed) {
  return {.what = fmt::format("{} (seed {})", words_of(*found.failures), seed),
          .advice = "Mend the simulator where it fails"};
}

}  // namespace

template <>
Findings judge<Check::sbc>(const MethodResults& m) {
  return {judge_p_value(m, {Check::sbc, words_of_ranks, too_few_ranks})};
}

template <>
Findings judge<Check::coverage>(const MethodResults& m) {
  return {
      judge_p_value(m, {Check::coverage, words_of_coverage<&Diagnosis::coverage>, too_few_ranks})};
}

template <>
Findings judge<Check::tarp>(const MethodResults& m) {
  return {judge_p_value(m, {Check::tarp, words_of_coverage<&Diagnosis::tarp>, too_few_ranks})};
}

template <>
Findings judge<Check::local_c2st>(const MethodResults& m) {
  return {judge_p_value(m, {Check::local_c2st, words_of_classifier})};
}

template <>
Findings judge<Check::training>(const MethodResults& m) {
  Index failed = 0;
  const std::size_t all = m.diagnoses.size();
  double gap = 0.0;
  Finding said;
  for (const auto* run : m.diagnoses) {
    const inference::TrainingCheck& check = *run->result.training;
    gap += check.generalization_gap / static_cast<double>(all);
    if (check.passes()) continue;
    if (failed++ == 0) said = words_of(check, m.method.training, run->use.seed);
  }
  if (failed == 0) {
    return {passes(
        {.evidence = fmt::format("gap {:.2g} nats (fine up to {:.2g})", gap, inference::kFarGap)})};
  }
  said.evidence += seeds_text(failed, all);
  return {fails(said)};
}

template <>
Findings judge<Check::predictive>(const MethodResults& m) {
  return {judge_p_value(m, {Check::predictive, words_of_prediction, too_few_predictions})};
}

// Right posteriors stay below 1.5, those three times too wide exceed it (docs/methods.md).
constexpr double kMostExcessWidth = 1.6;

// A refinement that trusts the likelihood less is wider on purpose.
double wanted_excess(const MethodResults& m) {
  double power = 1.0;
  for (const EvaluatedRun* run : m.runs) {
    if (const auto& certificate = run->notes.certificate) {
      power = std::min(power, certificate->power);
    }
  }
  return 1.0 / std::sqrt(power);
}

// Noise of a recording is what the best parameters leave of it. The size of heavy tails may be that
// of a few numbers, which a recording needn't have.
std::optional<Finding> overstated_noise(const ReportData& data) {
  constexpr double least = 0.75, num_deviations = 3.0;
  const ObservationNoise& stated = data.plan.study.observation_noise;
  const auto& left = data.baseline.misfit;
  if (!left || !left->noise_is_given || stated.is_correlated() || stated.is_heavy_tailed() ||
      !(left->times + num_deviations * left->deviation <= least * left->expected)) {
    return std::nullopt;
  }
  return Finding{
      .id = "noise",
      .what = "error bars are too wide, as observation_noise is larger than the recording's noise",
      .evidence =
          fmt::format("the best parameters leave errors of {} times the stated noise (fine from "
                      "{:.2g} on)",
                      short_number(left->times), least * left->expected),
      .advice = fmt::format("Multiply scale or std in [observation_noise] by {}",
                            short_number(left->times / left->expected))};
}

template <>
Findings judge<Check::width>(const MethodResults& m) {
  if (const auto noise = overstated_noise(m.data)) return {fails(*noise)};
  const double limit = kMostExcessWidth * wanted_excess(m);
  Index failed = 0;
  double largest = -1.0;
  std::string parameter;
  for (const auto* run : m.diagnoses) {
    const auto& width = run->result.width;
    if (!width) {
      return {
          cannot_tell({.what = "too few predictions succeeded to judge error bars by",
                       .evidence = fmt::format("{} samples (enough: {} that succeed)",
                                               run->result.num_samples, inference::kFewestForWidth),
                       .advice = "Raise num_samples in [diagnose]"})};
    }
    if (!width->is_random) return {passes({.evidence = "nothing is random, so no width is right"})};
    Index d = 0;
    const double found = width->excess.maxCoeff(&d);
    failed += found > limit ? 1 : 0;
    if (found <= largest) continue;
    largest = found;
    parameter = m.study.prior[static_cast<std::size_t>(d)].name;
  }
  const std::string size = fmt::format(
      "{} times the width expected from this observation (fine up to "
      "{})",
      short_number(largest), short_number(limit));
  if (failed == 0) return {passes({.evidence = size})};
  const bool is_motion = m.study.source().gives_motion;
  const bool can_refine = is_motion && !m.is(inference::Algorithm::refine);
  const Finding said = {.what = fmt::format("the error bars of {} {} too wide", parameter,
                                            is_motion ? "may be" : "are"),
                        .evidence = size + seeds_text(failed, m.diagnoses.size()),
                        .advice = can_refine ? advice_to_refine(m) : advice_to_learn(m)};
  // Rollouts that diverge from each other make right posteriors of motion look too wide.
  return {is_motion ? passes(said) : fails(said)};
}

template <>
Findings judge<Check::ood>(const MethodResults& m) {
  return {judge_p_value(m, {Check::ood, words_of_outlier, too_few_simulations})};
}

template <>
Findings judge<Check::failures>(const MethodResults& m) {
  return {judge_p_value(m, {Check::failures, words_of_failures})};
}

}  // namespace npdr::pipeline
