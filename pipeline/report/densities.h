/// How much the posteriors believe in parameters that somebody knows or has measured.
#pragma once

#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// One row a method and point (truth, references; nominal parameters where there is neither), one
/// column a round: log p of the posterior [nats], mean and standard deviation over the seeds,
/// beside that of the prior. Only for studies that evaluate all rounds.
analysis::Table densities_table(const ReportData& data);

/// Footnotes for a table of densities: methods that take parameters as known, whose densities can't
/// be compared with those of all parameters; references that set parameters beyond the prior's.
void note_known_parameters(analysis::Table& table, const ReportData& data);
void note_fixed_parameters(analysis::Table& table, const ReportData& data);

}  // namespace npdr::pipeline
