#include "pipeline/apps/marginal_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace npdr::pipeline {
namespace {

using Kind = inference::Marginal::Kind;

constexpr std::ptrdiff_t kMostLevels = 10'000, kFewLevels = 20;

// To two digits of `step`.
double rounded(double value, double step) {
  if (!(step > 0.0)) return value;
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(step))), 0, 300);
  return std::stod(fmt::format("{:.{}f}", value, decimals));
}

// How much larger the largest step between the values is than the smallest.
template <class Map>
double unevenness(const std::set<double>& values, const Map& map) {
  double least = HUGE_VAL, most = 0.0;
  for (auto value = values.begin(); std::next(value) != values.end(); ++value) {
    const double step = map(*std::next(value)) - map(*value);
    least = std::min(least, step);
    most = std::max(most, step);
  }
  return most / least;
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
    if (std::ssize(different_) <= kMostLevels) different_.insert(value);
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
    values_.observe(value, count_);
    if (low_ > 0.0) logarithms_.observe(std::log(value), count_);
  }
}

double MarginalFit::num_steps() const {
  const Index num_levels = std::ssize(different_);
  return static_cast<double>((num_levels > kMostLevels ? count_ : num_levels) - 1);
}

bool MarginalFit::is_even_grid() const {
  return std::ssize(different_) <= kFewLevels &&
         unevenness(different_, [](double v) { return v; }) <=
             unevenness(different_, [](double v) { return std::log(v); });
}

inference::Marginal MarginalFit::likeliest() const {
  inference::Marginal best{.name = "", .unit = "", .kind = Kind::uniform, .a = low_, .b = high_};
  if (is_constant()) return best;
  const double half = 0.5 * (high_ - low_) / num_steps();
  best.a = rounded(low_ - half, half);
  if (low_ > 0.0) best.a = std::max(best.a, 0.0);
  best.b = rounded(high_ + half, half);
  double most = -std::log(high_ - low_) + 3.0 / static_cast<double>(count_);
  const auto consider = [&](Kind kind, double a, double b, double mean_log_density) {
    if (!(mean_log_density > most)) return;
    most = mean_log_density;
    best = {.name = "", .unit = "", .kind = kind, .a = a, .b = b};
  };
  const double variance = values_.variance(count_);
  consider(Kind::normal, values_.mean, std::sqrt(variance), log_normal_density(variance));
  if (!(low_ > 0.0)) return best;
  const double mean = logarithms_.mean, of_log = logarithms_.variance(count_);
  const double factor = std::pow(high_ / low_, 0.5 / num_steps());
  const double low = low_ / factor, high = high_ * factor;
  if (!is_even_grid()) {
    consider(Kind::log_uniform, rounded(low, std::min(low, low_ - low)),
             rounded(high, high - high_), -std::log(std::log(high_ / low_)) - mean);
  }
  consider(Kind::log_normal, mean, std::sqrt(of_log), log_normal_density(of_log) - mean);
  return best;
}

}  // namespace npdr::pipeline
