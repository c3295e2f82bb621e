/// The figure of a system that moves on a plane: recorded and predicted paths seen from above.
#pragma once

#include <filesystem>
#include <optional>

#include "pipeline/report/data.h"

namespace npdr::pipeline {

inline constexpr Index kDrawnSamples = 30;  ///< of each method

/// Paths and shapes at posterior samples of the first seed, against `target` and, where there are
/// any, the held-out rollouts; returns the SVG. Nothing for a simulator without outlines.
std::optional<std::filesystem::path> write_path_figure(const ReportData& data, const Target& target,
                                                       const std::optional<Target>& held_out,
                                                       const std::filesystem::path& folder);

}  // namespace npdr::pipeline
