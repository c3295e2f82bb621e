/// What fields of a study may hold, beyond the general rules of constraint.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/constants.h"
#include "inference/prior.h"
#include "pipeline/config/constraint.h"

namespace npdr::pipeline {

/// The widest layer of a network, and the most layers, transforms or components: far beyond what
/// trains, and a network of a hostile file still fits in memory.
inline constexpr double kMaxWidth = 4096;
inline constexpr double kMaxLayers = 128;
/// The most rollouts, steps or channels of a posterior file: their product fits into an integer.
inline constexpr double kMaxSeries = 1e6;
/// Parameters that a prior may have.
inline constexpr std::size_t kMostParameters = 1000;

/// [median, deviation] of noise, the median above `low` and below `high`, the deviation > 0.
Constraint<std::vector<double>> noise_prior(double low, const std::string& name,
                                            double high = kInfinity);
Constraint<double> degrees_constraint();
/// States of a smoother's window: odd, 5 to 1001.
Constraint<double> window_constraint();
Constraint<std::vector<std::uint64_t>> seeds_constraint();
Constraint<std::vector<std::uint64_t>> rollouts_constraint();
/// A number of folds, or none.
Constraint<double> folds_constraint();
Constraint<std::vector<std::string>> metrics_constraint();
Constraint<std::vector<std::string>> checks_constraint();
/// [low, high].
Constraint<std::vector<double>> range_constraint();
/// Ascending.
Constraint<std::vector<double>> ascending();
Constraint<std::vector<inference::Marginal>> prior_constraint();
/// Memory as Slurm takes it: "2G"; "" for none.
Constraint<std::string> memory_constraint();
/// Time as Slurm takes it: "90", "01:30:00", "1-12"; "" for none.
Constraint<std::string> time_constraint();
/// [s] of such a time: "90" (minutes), "MM:SS", "HH:MM:SS", "D-HH[:MM[:SS]]"; none for "".
std::optional<double> seconds_of(const std::string& time);
/// Value behind the = of a batch system's option: one word, or nothing.
Constraint<std::string> option_value();
/// Lines such as "--qos=long".
Constraint<std::vector<std::string>> options_constraint();
Constraint<std::vector<std::string>> shell_lines();

}  // namespace npdr::pipeline
