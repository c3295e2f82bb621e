#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>

#include "analysis/quantiles.h"
#include "core/normal.h"
#include "inference/diagnostics/uniformity.h"
#include "inference/prior.h"
#include "pipeline/report/registry.h"
#include "pipeline/report/table_parts.h"
#include "pipeline/sources/dataset_rows.h"
#include "pipeline/store/hash.h"

namespace npdr::pipeline {
namespace {

std::string prior_text(const inference::Marginal& m) {
  switch (m.kind) {
    case inference::Marginal::Kind::uniform:
      return fmt::format("[{:.4g}, {:.4g}]", m.a, m.b);
    case inference::Marginal::Kind::log_uniform:
      return fmt::format("[{:.4g}, {:.4g}], log-uniform", m.a, m.b);
    case inference::Marginal::Kind::normal:
      return fmt::format("N({:.4g}, {:.4g}²)", m.a, m.b);
    case inference::Marginal::Kind::log_normal:
      return fmt::format("exp N({:.4g}, {:.4g}²)", m.a, m.b);
  }
  return "";
}

constexpr Index kMostRows = 10'000;
constexpr double kFalseAlarmRate = 1e-4;

// Of those that the first seed trains on.
Index num_rows_of(const ReportData& data) {
  const MethodConfig& method = data.plan.study.method(data.methods.front());
  return std::min(kMostRows, method.algorithm.num_simulations);
}

// Rows inside the prior that the first seed trains on, in the space in which it is N(0, I).
RowMatrix normal_theta(const ReportData& data) {
  const inference::Prior prior(data.plan.study.prior);
  const Index count = num_rows_of(data);
  const RowMatrix all = *data.plan.source->theta(data.seeds.front(), count);
  RowMatrix inside(all.rows(), all.cols());
  Index num_inside = 0;
  for (Index i = 0; i < all.rows(); ++i) {
    if (prior.contains(all.row(i).transpose())) inside.row(num_inside++) = all.row(i);
  }
  return prior.to_normal(inside.topRows(num_inside));
}

// Rows of theta and x that are the same as earlier ones: they count several times, and stand on
// both sides where some rows judge what others have taught.
void note_copies(Table& table, const ReportData& data) {
  const Study& study = data.plan.study;
  if (study.source().simulates) return;
  const DatasetFile dataset = open_dataset(study);
  const Index count = num_rows_of(data);
  auto rows = dataset_rows(data.seeds.front(), dataset.num_rows(), count);
  std::ranges::sort(rows);          // as the file has them, which is faster read
  std::set<std::string> different;  // hashes: rows may have very many features
  constexpr Index block = 256;
  for (Index begin = 0; begin < count; begin += block) {
    const auto some = std::span(rows).subspan(
        static_cast<std::size_t>(begin), static_cast<std::size_t>(std::min(block, count - begin)));
    const RowMatrix theta = dataset.theta(some), x = dataset.x(some);
    for (Index i = 0; i < theta.rows(); ++i) {
      Hasher row;
      row.add_bytes(theta.row(i).data(), static_cast<std::size_t>(theta.cols()) * sizeof(double));
      row.add_bytes(x.row(i).data(), static_cast<std::size_t>(x.cols()) * sizeof(double));
      different.insert(row.hex());
    }
  }
  const Index copies = count - std::ssize(different);
  if (copies == 0) return;
  table.footnote(fmt::format(
      "{} of {} rows of the dataset are copies of others, theta and x: they count several times; "
      "leave each in it once",
      copies, count));
}

// Posteriors are those of the distribution that the dataset's theta was drawn from: says which
// parameters aren't distributed as the prior. Kolmogorov-Smirnov of F(theta), which is uniform for
// draws of the prior; a dataset without fault is accused with probability kFalseAlarmRate.
void note_foreign_theta(Table& table, const ReportData& data) {
  if (data.plan.study.source().simulates) return;
  const RowMatrix u = normal_theta(data);
  if (u.rows() == 0) return;
  for (Index d = 0; d < u.cols(); ++d) {
    const Vector uniform = u.col(d).unaryExpr([](double v) { return normal_cdf(v); });
    const auto test = inference::test_kolmogorov_smirnov(uniform);
    if (inference::corrected(test.p_value, u.cols()) >= kFalseAlarmRate) continue;
    table.footnote(fmt::format(
        "{} of the dataset isn't distributed as the prior says (Kolmogorov-Smirnov {:.2f}, p = "
        "{:.1g}): where its theta wasn't drawn from this prior, posteriors are those of another "
        "one",
        data.plan.study.prior[static_cast<std::size_t>(d)].name, test.statistic, test.p_value));
  }
}

std::string period_note(double period) {
  return fmt::format("modulo {:.4g}: values that far apart are the same system", period);
}

Cell posterior_cell(Table& table, const ReportData& data, const std::string& method, Index d) {
  const double period = data.period_of(d);
  const Vector samples = samples_of(data, method, d);
  Cell cell(data.summary_of(d, samples));
  if (!data.is_inferred(method, d)) {
    cell = Cell(samples(0));
    note_known(table, cell);
  }
  if (period > 0.0) cell.notes.push_back(table.footnote(period_note(period)));
  return cell;
}

// 5 % and 95 % quantiles.
Cell interval_cell(const ReportData& data, const std::string& method, Index d) {
  if (!data.is_inferred(method, d)) return {};
  const Vector samples = unwrapped_samples_of(data, method, d);
  std::vector<double> sorted(samples.begin(), samples.end());
  std::ranges::sort(sorted);
  return fmt::format("[{:.4g}, {:.4g}]", analysis::quantile_of_sorted(sorted, 0.05),
                     analysis::quantile_of_sorted(sorted, 0.95));
}

Table make_intervals(const ReportData& data) {
  Table table =
      empty_table("Domain parameters: 5 % and 95 % quantiles of the posterior, all seeds.",
                  "Parameter", {"unit"});
  add_columns(table, data.methods);
  Index d = 0;
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    Row row{marginal.name, {marginal.unit}};
    for (const std::string& method : data.methods) {
      row.cells.push_back(interval_cell(data, method, d));
    }
    table.rows.push_back(std::move(row));
    ++d;
  }
  return table;
}

Table make(const ReportData& data) {
  Table table =
      empty_table("Domain parameters: mean and standard deviation of the posterior, all seeds.",
                  "Parameter", {"unit", "prior"});
  for (const BaselinePoint& point : data.baseline.points) add_columns(table, {point.name});
  add_columns(table, data.methods);
  Index d = 0;
  for (const inference::Marginal& marginal : data.plan.study.prior) {
    Row row{marginal.name, {marginal.unit, prior_text(marginal)}};
    for (const BaselinePoint& point : data.baseline.points) row.cells.emplace_back(point.theta(d));
    for (const std::string& method : data.methods) {
      row.cells.push_back(posterior_cell(table, data, method, d));
    }
    table.rows.push_back(std::move(row));
    ++d;
  }
  note_foreign_theta(table, data);
  note_copies(table, data);
  return table;
}

}  // namespace

/// Prior, baselines and posteriors: mean and deviation, circular for a periodic parameter.
TableEntry parameters_table() { return {"parameters", Section::posteriors, has_posteriors, make}; }

/// What 90 % of each posterior's samples lie in, parameter by parameter.
TableEntry intervals_table() {
  return {"intervals", Section::posteriors, has_posteriors, make_intervals};
}

}  // namespace npdr::pipeline
