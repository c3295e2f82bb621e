/// The figures of a study's report.
#pragma once

#include <filesystem>

#include "pipeline/stages/report_data.h"

namespace npdr::pipeline {

/// Pair plot of the first seed's posterior samples of every method; returns the SVG.
std::filesystem::path write_pair_figure(const ReportData& data,
                                        const std::filesystem::path& folder);

/// Recorded and predicted trajectories of the first seed; returns the SVG.
std::filesystem::path write_trajectory_figure(const ReportData& data, const Target& target,
                                              const std::filesystem::path& folder);

}  // namespace npdr::pipeline
