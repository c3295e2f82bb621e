/// The figures of a study's report.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// The methods that figures draw: the first, as many as there are colours.
std::span<const std::string> drawn_methods(const ReportData& data);

/// What figures leave out, as sentences to end a caption with; "": nothing. They draw the first
/// methods, as many as there are colours, and those parameters that the study picks, or the first.
std::string left_out_methods(const ReportData& data);
std::string left_out_parameters(const Study& study);

/// Pair plot of the first seed's posterior samples of each method; returns the SVG.
std::filesystem::path write_pair_figure(const ReportData& data,
                                        const std::filesystem::path& folder);

/// Recorded and predicted trajectories of the first seed; returns the SVG.
std::filesystem::path write_trajectory_figure(const ReportData& data, const Target& target,
                                              const std::filesystem::path& folder);

}  // namespace npdr::pipeline
