/// The table of a study's single experiments.
#pragma once

#include "analysis/table.h"
#include "pipeline/stages/report_data.h"

namespace npdr::pipeline {

/// One row a method and seed: fit, densities, simulations, epochs, chains.
analysis::Table seeds_table(const ReportData& data);

}  // namespace npdr::pipeline
