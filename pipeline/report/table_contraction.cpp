#include "pipeline/findings/findings.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {

/// Contraction of each parameter (findings.h).
std::optional<Table> contraction_table(const ReportData& data) {
  if (!has_posteriors(data)) return std::nullopt;
  auto table = table_of_parameters(
      data,
      "What the data tell about each parameter: 1 - posterior variance / prior variance, mean and "
      "standard deviation over seeds. 0: nothing, 1: all; below 0: the posterior is wider. Of "
      "logarithms where the prior is log_uniform or log_normal.");
  table.add_each(data.methods, [&](const std::string& method, Index d) {
    return data.is_inferred(method, d) ? Cell(analysis::summarize(contraction(data, method, d)))
                                       : known_cell();
  });
  return table.make();
}

}  // namespace npdr::pipeline
