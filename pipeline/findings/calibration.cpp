// Checks of the network of round 1 over fresh simulations of the prior.
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

}  // namespace npdr::pipeline
