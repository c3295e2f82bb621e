#include "pipeline/findings/findings.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

Cell contraction_cell(Table& table, const ReportData& data, const std::string& method, Index d) {
  if (!data.is_inferred(method, d)) {
    Cell cell;
    note_known(table, cell);
    return cell;
  }
  return analysis::summarize(contraction(data, method, d));
}

Table make_contraction_table(const ReportData& data) {
  Table table = empty_table(
      "What the data tell about each parameter: 1 - posterior variance / prior variance, mean and "
      "standard deviation over seeds. 0: nothing, 1: all; below 0: the posterior is wider. Of "
      "logarithms where the prior is log_uniform or log_normal.",
      "Parameter", data.methods);
  for (Index d = 0; d < std::ssize(data.plan.study.prior); ++d) {
    add_row(table, data.marginal(d).name, data.methods,
            [&](const std::string& method) { return contraction_cell(table, data, method, d); });
  }
  return table;
}

}  // namespace

/// Contraction of each parameter (findings.h).
TableEntry contraction_table() {
  return {"contraction", Section::details, has_posteriors, make_contraction_table};
}

}  // namespace npdr::pipeline
