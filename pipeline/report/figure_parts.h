/// Pieces that the figures of a report share.
#pragma once

#include <string>
#include <vector>

#include "analysis/figure.h"
#include "pipeline/findings/data.h"

namespace npdr::pipeline {

/// The methods that figures draw: the first, as many as there are colors.
std::vector<std::string> drawn_methods(std::vector<std::string> methods);
/// A sentence that ends captions: " The first 6 of 7 methods."; "": all are drawn.
std::string left_out_methods(const std::vector<std::string>& methods);

/// Positions in the prior of the parameters that figures show: those that the study picks, or the
/// first.
std::vector<Index> shown_parameters(const Study& study);
/// As left_out_methods(): " 2 of 16 parameters."
std::string left_out_parameters(const Study& study);

/// Quantiles of each column of samples (n, D) at analysis::kIntervalLevels, (D, 5); samples that
/// aren't finite are left out. NaN where none is left.
RowMatrix interval_quantiles(const RowMatrix& samples);

}  // namespace npdr::pipeline
