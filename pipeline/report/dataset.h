/// What a report says of a study's dataset.
#pragma once

#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// Says below a table which parameters of the dataset aren't distributed as the study's prior:
/// posteriors are those of the distribution that theta was drawn from. Kolmogorov-Smirnov of
/// F(theta), which is uniform for draws of the prior, over at most 10,000 rows inside its support;
/// a dataset without fault is accused with probability 1e-4.
void note_foreign_theta(const ReportData& data, analysis::Table& table);

}  // namespace npdr::pipeline
