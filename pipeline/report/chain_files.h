/// A method's results as chains in plain text, for GetDist and for programs that read what CmdStan
/// writes.
#pragma once

#include <string>

#include "core/enum_names.h"
#include "pipeline/plan/plan.h"

namespace npdr::pipeline {

/// Formats of `npdr export`.
enum class ExportFormat { netcdf, getdist, cmdstan };

constexpr auto enum_table(ExportFormat) {
  using enum ExportFormat;
  return std::to_array<EnumRow<ExportFormat>>(
      {{netcdf, "netcdf"}, {getdist, "getdist"}, {cmdstan, "cmdstan"}});
}

/// Writes the samples of the last posteriors of the plan's only method, a chain a seed in a file of
/// its own, with log densities [nats]:
///  - getdist: <root>_1.txt, ...: weight (1), -log p, parameters; <root>.paramnames: names and
///    LaTeX; <root>.ranges: bounds of the prior;
///  - cmdstan: <root>_1.csv, ...: lp__, parameters.
/// Returns the files. Throws InputError for several methods, for what isn't made yet, and where a
/// file of another export would be taken for one more chain.
std::vector<std::string> write_chain_files(const Plan& plan, const std::string& root,
                                           ExportFormat format);

}  // namespace npdr::pipeline
