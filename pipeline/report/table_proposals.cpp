#include <fmt/format.h>

#include <algorithm>

#include "core/normal.h"
#include "pipeline/artefacts/proposal_file.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostRows = 10'000;  // of a proposal, all of them draws of the same

Index num_rounds(const ReportData& data, const std::string& method) {
  return data.plan.study.method(method).algorithm.num_rounds;
}

bool has_rounds(const ReportData& data) {
  return std::ranges::any_of(
      data.methods, [&](const std::string& method) { return num_rounds(data, method) > 1; });
}

// Parameters (n, D) that a round of a method has simulated, of all seeds; of an outer loop in its
// last iteration.
RowMatrix proposals_of(const ReportData& data, const std::string& method, Index round) {
  RowMatrix all(0, std::ssize(data.plan.study.prior));
  for (const Node& node : data.plan.nodes) {
    const bool is_its = std::ranges::any_of(node.uses, [&](const Use& use) {
      const bool is_last =
          use.iteration == 0 ||
          use.iteration == data.plan.study.num_iterations_of(data.plan.study.method(method));
      return use.method == method && use.round == round && use.fold == 0 && is_last;
    });
    if (node.stage != Stage::propose || !is_its || !is_complete(data.plan, node)) continue;
    const h5::Dataset theta = open_proposal(node);
    const RowMatrix rows = read_proposal(theta, {0, std::min(kMostRows, theta.num_rows())});
    all.conservativeResize(all.rows() + rows.rows(), Eigen::NoChange);
    all.bottomRows(rows.rows()) = rows;
  }
  return all;
}

Row prior_row(const ReportData& data) {
  Row row{"prior", {}};
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    const inference::Prior prior({marginal});
    const Eigen::Vector2d u(normal_quantile(0.05), normal_quantile(0.95));
    const RowMatrix theta = prior.to_theta(u);
    row.cells.push_back(interval_text(theta(0, 0), theta(1, 0)));
  }
  return row;
}

Row round_row(const std::string& label, const RowMatrix& theta) {
  Row row{label, {}};
  for (const auto& column : theta.colwise()) row.cells.push_back(interval_text(column));
  return row;
}

Table make_proposals_table(const ReportData& data) {
  Table table = empty_table(
      "Where rounds have simulated: 5 % and 95 % quantiles of their proposals, all seeds. Round 1 "
      "draws from the prior, each further one where the posterior of the round before it is.",
      "Method, round", {});
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    add_columns(table, {marginal.name});
  }
  table.rows.push_back(prior_row(data));
  for (const std::string& method : data.methods) {
    for (Index round = 2; round <= num_rounds(data, method); ++round) {
      const RowMatrix theta = proposals_of(data, method, round);
      if (theta.rows() == 0) continue;  // no longer there
      table.rows.push_back(round_row(fmt::format("{}, {}", method, round), theta));
    }
  }
  return table;
}

}  // namespace

/// One row a method and round beyond the first, one column a parameter.
TableEntry proposals_table() {
  return {"proposals", Section::details, has_rounds, make_proposals_table};
}

}  // namespace npdr::pipeline
