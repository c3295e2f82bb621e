/// The table of a study's single experiments.
#pragma once

#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// One row a method and seed: fit, densities, simulations, epochs, chains.
analysis::Table seeds_table(const ReportData& data);

}  // namespace npdr::pipeline
