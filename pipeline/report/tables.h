/// The tables of a study's report.
#pragma once

#include <optional>

#include "analysis/table.h"
#include "pipeline/report/data.h"

namespace npdr::pipeline {

/// How well each method's posterior samples fit the target domain: the twin of Tables 2 and A2,
/// with the published figures, the nominal parameters and the floor beside them.
analysis::Table fit_table(const ReportData& data);

/// Says below the fit table how many of the target's rollouts, and of the held-out ones, reach the
/// goal themselves; nothing unless the study measures that.
void note_recorded_goal(const ReportData& data, const Target& target,
                        const std::optional<Target>& held_out, analysis::Table& table);

/// One row a method, one column a round: RMSE (or the first metric of the study). Only for studies
/// that evaluate all rounds.
analysis::Table rounds_table(const ReportData& data);

}  // namespace npdr::pipeline
