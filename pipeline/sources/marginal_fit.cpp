#include "pipeline/sources/marginal_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/error.h"

namespace npdr::pipeline {
namespace {

using Kind = inference::Marginal::Kind;

constexpr std::ptrdiff_t kMostLevels = 1000;
constexpr double kLeastOfHalfStep = 0.05;

// To two digits of `step`.
double rounded(double value, double step) {
  if (!(step > 0.0) || !std::isfinite(step)) return value;
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(step))), 0, 300);
  return std::stod(fmt::format("{:.{}f}", value, decimals));
}

inference::Marginal marginal(Kind kind, double a, double b) {
  return {.name = "", .unit = "", .kind = kind, .a = a, .b = b};
}

// The mean log density of a normal at its own maximum.
double log_normal_density(double variance) {
  return -0.5 * std::log(2.0 * std::numbers::pi * std::numbers::e * variance);
}

}  // namespace

void MarginalFit::Moments::observe(double value, Index count) {
  const double before = value - mean;
  mean += before / static_cast<double>(count);
  sum_of_squares += before * (value - mean);
}

void MarginalFit::observe(const Vector& values) {
  for (const double value : values) {
    ++count_;
    if (std::ssize(levels_) <= kMostLevels) ++levels_[value];
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    values_.observe(value, count_);
    if (low_ > 0.0) logarithms_.observe(std::log(value), count_);
  }
}

double MarginalFit::num_steps() const {
  const Index num_levels = std::ssize(levels_);
  return static_cast<double>((num_levels > kMostLevels ? count_ : num_levels) - 1);
}

double MarginalFit::num_draws() const {
  const bool counts_each = std::ssize(levels_) > kMostLevels || inference::are_chosen(levels_);
  return static_cast<double>(counts_each ? count_ : std::ssize(levels_));
}

inference::Marginal MarginalFit::uniform() const {
  const double half = 0.5 * (high_ - low_) / num_steps();
  const double low = rounded(low_ - half, half);
  const bool is_positive = low_ > (inference::is_design(levels_) ? kLeastOfHalfStep * half : 0.0);
  return marginal(Kind::uniform, is_positive ? std::max(low, 0.0) : low,
                  rounded(high_ + half, half));
}

inference::Marginal MarginalFit::log_uniform() const {
  const double factor = std::pow(high_ / low_, 0.5 / num_steps());
  const double low = low_ / factor, high = high_ * factor;
  return marginal(Kind::log_uniform, rounded(low, std::min(low, low_ - low)),
                  rounded(high, high - high_));
}

inference::Marginal MarginalFit::normal() const {
  return marginal(Kind::normal, values_.mean, std::sqrt(values_.variance(count_)));
}

inference::Marginal MarginalFit::log_normal() const {
  return marginal(Kind::log_normal, logarithms_.mean, std::sqrt(logarithms_.variance(count_)));
}

inference::Marginal MarginalFit::likeliest_of_draws() const {
  inference::Marginal best = uniform();
  const double margin = 3.0 / num_draws();
  double most = -std::log(high_ - low_);
  const auto consider = [&](double mean_log_density, const inference::Marginal& form) {
    if (!(mean_log_density > most + margin)) return;
    most = mean_log_density;
    best = form;
  };
  consider(log_normal_density(values_.variance(count_)), normal());
  if (!(low_ > 0.0)) return best;
  const double mean = logarithms_.mean;
  consider(-std::log(std::log(high_ / low_)) - mean, log_uniform());
  consider(log_normal_density(logarithms_.variance(count_)) - mean, log_normal());
  return best;
}

inference::Marginal MarginalFit::nearest_to_grid() const {
  constexpr double near = 0.05;
  const bool is_even = inference::filled_by_steps(levels_) >= inference::filled_by_factors(levels_);
  std::vector<inference::Marginal> forms = {is_even ? uniform() : log_uniform(), normal()};
  if (low_ > 0.0) forms.insert(forms.end(), {is_even ? log_uniform() : uniform(), log_normal()});
  const auto distance = [&](const inference::Marginal& form) {
    try {
      return inference::distance_of_levels(levels_, form);
    } catch (const InputError&) {  // no prior: levels are as far or as near as numbers can be
      return 1.0;
    }
  };
  if (distance(forms.front()) <= near) return forms.front();
  return *std::ranges::min_element(forms, {}, distance);
}

inference::Marginal MarginalFit::likeliest() const {
  if (is_constant()) return marginal(Kind::uniform, low_, high_);
  return inference::is_design(levels_) ? nearest_to_grid() : likeliest_of_draws();
}

}  // namespace npdr::pipeline
