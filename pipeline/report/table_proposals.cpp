#include <fmt/format.h>

#include <algorithm>

#include "core/normal.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/plan/completeness.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"

namespace npdr::pipeline {
namespace {

constexpr Index kMostProposed = 10'000;  // of a proposal, all of them draws of the same

// Parameters (n, D) that a round of a method has simulated, of all seeds; of an outer loop in its
// last iteration.
RowMatrix proposals_of(const ReportData& data, const MethodConfig& method, Index round) {
  const Index last_iteration = data.plan.study.num_iterations_of(method);
  RowMatrix all(0, std::ssize(data.plan.study.prior));
  for (const Node& node : data.plan.nodes) {
    const bool is_its = std::ranges::any_of(node.uses, [&](const Use& use) {
      const bool is_last = use.iteration == 0 || use.iteration == last_iteration;
      return use.method == method.name && use.round == round && use.fold == 0 && is_last;
    });
    if (node.stage != Stage::propose || !is_its || !is_complete(data.plan, node)) continue;
    const h5::Dataset theta = open_proposal(node);
    const RowMatrix rows = read_proposal(theta, {0, std::min(kMostProposed, theta.num_rows())});
    all.conservativeResize(all.rows() + rows.rows(), Eigen::NoChange);
    all.bottomRows(rows.rows()) = rows;
  }
  return all;
}

// Intervals of the prior, or of what a round has simulated, of each parameter.
struct ProposalRow {
  std::string label;
  std::vector<std::string> intervals;
};

ProposalRow prior_row(const ReportData& data) {
  ProposalRow row{"prior", {}};
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    const Eigen::Vector2d u(normal_quantile(0.05), normal_quantile(0.95));
    const RowMatrix theta = inference::Prior({marginal}).to_theta(u);
    row.intervals.push_back(interval_text(theta(0, 0), theta(1, 0)));
  }
  return row;
}

std::vector<ProposalRow> proposal_rows(const ReportData& data) {
  std::vector<ProposalRow> rows = {prior_row(data)};
  for (const std::string& name : data.methods) {
    const MethodConfig& method = data.plan.study.method(name);
    for (Index round = 2; round <= method.algorithm.num_rounds; ++round) {
      const RowMatrix theta = proposals_of(data, method, round);
      if (theta.rows() == 0) continue;  // no longer there
      ProposalRow& row = rows.emplace_back(ProposalRow{fmt::format("{}, {}", name, round), {}});
      for (const auto& column : theta.colwise()) row.intervals.push_back(interval_text(column));
    }
  }
  return rows;
}

}  // namespace

/// One row a method and round beyond the first, one column a parameter.
std::optional<Table> proposals_table(const ReportData& data) {
  const auto has_rounds = [&](const std::string& method) {
    return data.plan.study.method(method).algorithm.num_rounds > 1;
  };
  if (std::ranges::none_of(data.methods, has_rounds)) return std::nullopt;
  TableOf<ProposalRow> table{
      .caption =
          "Where rounds have simulated: 5 % and 95 % quantiles of their proposals, all "
          "seeds. Round 1 draws from the prior, each further one where the posterior of "
          "the round before it is.",
      .row_header = "Method, round",
      .rows = proposal_rows(data),
      .label = &ProposalRow::label};
  for (std::size_t d = 0; d < data.plan.study.prior.size(); ++d) {
    table.add(data.plan.study.prior[d].name,
              [d](const ProposalRow& row) { return row.intervals[d]; });
  }
  return table.make();
}

}  // namespace npdr::pipeline
