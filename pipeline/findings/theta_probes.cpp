#include "pipeline/findings/probe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/constants.h"
#include "core/normal.h"
#include "inference/diagnostics/levels.h"
#include "inference/diagnostics/uniformity.h"
#include "pipeline/sources/marginal_fit.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

constexpr double kFalseAlarmRate = 1e-4;

// One parameter of all rows.
struct Column {
  const Marginal& prior;
  Vector values;
  inference::Levels levels;
  Index num_draws = 0;  // that are independent
};

double share_of(const Column& column, const inference::Levels::value_type& level) {
  return static_cast<double>(level.second) / static_cast<double>(column.values.size());
}

bool lies_on_a_bound(const Column& column, double value) {
  constexpr double end = 1e-6;
  if (!column.prior.is_uniform()) return false;
  const double f = normal_cdf(
      inference::Prior({column.prior}).to_normal(RowMatrix::Constant(1, 1, value))(0, 0));
  return f < end || f > 1.0 - end;
}

// An end that is far more frequent than others, of values that aren't those of a coarse grid.
bool looks_clipped(const Column& column, double share) {
  constexpr double times_usual = 5.0, most_filled = 0.1;
  const double filled = std::max(inference::filled_by_steps(column.levels),
                                 inference::filled_by_factors(column.levels));
  return filled < most_filled && share * static_cast<double>(column.levels.size()) > times_usual;
}

// Of few levels, or many that fill a grid; what is clipped has many.
bool has_steps(const Column& column) {
  return std::ssize(column.levels) <= inference::kFewLevels || inference::is_grid(column.levels);
}

std::string share_text(double share, double limit) {
  return fmt::format("{:.2g} of the rows (fine below {:.2g})", share, limit);
}

std::string advice_at_the_ends(const Column& column) {
  const std::string& name = column.prior.name;
  if (!has_steps(column))
    return fmt::format("Draw {} from the prior, or leave these rows out", name);
  MarginalFit fit;
  fit.observe(column.values);
  const Marginal around = fit.likeliest();
  return fmt::format("Set prior.{} = {{ {} = [{:.6g}, {:.6g}] }}, which ends half of a step beyond",
                     name, name_of(around.kind), around.a, around.b);
}

// A design wasn't drawn: all of its rows tell of it.
Index num_draws_of(const inference::Levels& levels, Index num_rows, Index num_different_rows) {
  if (inference::is_design(levels)) return num_rows;
  return inference::are_chosen(levels) ? num_different_rows : std::ssize(levels);
}

class Inspection {
 public:
  Inspection(const RowMatrix& theta, const inference::Prior& prior) : theta_(theta), prior_(prior) {
    std::set<std::vector<double>> different;
    for (const auto& row : theta.rowwise()) different.emplace(row.begin(), row.end());
    num_different_ = std::ssize(different);
    for (Index d = 0; d < theta.cols(); ++d) {
      const inference::Levels levels = inference::levels_of(theta.col(d));
      columns_.push_back({prior.marginals()[static_cast<std::size_t>(d)], theta.col(d), levels,
                          num_draws_of(levels, theta.rows(), num_different_)});
    }
  }

  Findings inspect() {
    for (const Column& column : columns_) {
      if (column.levels.size() == 1) {
        tell_constant(column);
        continue;
      }
      find_values_at_the_ends(column);
      find_another_prior(column);
    }
    find_correlation();
    return std::move(found_);
  }

 private:
  void tell(Finding fault, bool is_grave) {
    fault.severity = is_grave ? Severity::wrong : Severity::suspicious;
    found_.push_back(std::move(fault));
  }

  void tell_constant(const Column& column) {
    const std::string& name = column.prior.name;
    tell({.id = "constant",
          .what =
              fmt::format("{} of the dataset is the same in all rows, which networks learn", name),
          .evidence = fmt::format("{} in all rows", column.values(0)),
          .advice = fmt::format("Leave {} out of [prior]", name)},
         true);
  }

  // At the one that has more.
  void find_values_at_the_ends(const Column& column) {
    const auto &lowest = *column.levels.begin(), &highest = *column.levels.rbegin();
    const bool is_lowest_first = lowest.second >= highest.second;
    if (!tell_end(column, is_lowest_first ? lowest : highest)) {
      tell_end(column, is_lowest_first ? highest : lowest);
    }
  }

  bool tell_end(const Column& column, const inference::Levels::value_type& level) {
    constexpr double least = 0.02, grave = 0.075;
    constexpr Index fewest = 5;  // draws have an extreme, too, which bounds may be taken from
    const double share = share_of(column, level);
    if (share < least || level.second < fewest) return false;
    const bool is_bound = lies_on_a_bound(column, level.first);
    if (!is_bound && !looks_clipped(column, share)) return false;
    const char* end = is_bound ? "an end of the prior" : "an end of its values, as if clipped";
    tell({.id = "end",
          .what = fmt::format("many rows have {} = {:.6g}, {}, where posteriors are cut",
                              column.prior.name, level.first, end),
          .evidence = share_text(share, least),
          .advice = advice_at_the_ends(column)},
         share > grave);
    return true;
  }

  void find_another_prior(const Column& column) {
    constexpr double grave = 0.05;
    const double distance = inference::distance_of_levels(column.levels, column.prior);
    const double p_value =
        inference::p_value_of_levels(column.levels, column.prior, column.num_draws);
    if (inference::corrected(p_value, theta_.cols()) >= kFalseAlarmRate) return;
    tell({.id = "prior",
          .what = fmt::format("{} of the dataset was not drawn as [prior] says", column.prior.name),
          .evidence = fmt::format("distribution functions differ by {:.2g} (fine up to {:.2g}), p "
                                  "= {:.1g}",
                                  distance, grave, p_value),
          .advice = fmt::format("State in [prior] how {} was drawn", column.prior.name)},
         distance > grave);
  }

  // Of F, with a deviation of 1 / sqrt(n) where they don't correlate, nearly normal for few rows,
  // since F is bounded.
  void find_correlation() {
    constexpr double grave = 0.2;
    const RowMatrix r = correlations();
    const CorrelatedPair pair = most_correlated(r.cwiseProduct(roots_of_draws()));
    const Index num_pairs = theta_.cols() * (theta_.cols() - 1) / 2;
    const double p_value = std::erfc(std::abs(pair.correlation) * std::sqrt(0.5));
    if (num_pairs == 0 || inference::corrected(p_value, num_pairs) >= kFalseAlarmRate) return;
    const double correlation = r(pair.first, pair.second);
    const auto name = [&](Index d) { return prior_.marginals()[static_cast<std::size_t>(d)].name; };
    tell({.id = "correlated",
          .what = fmt::format("{} and {} of the dataset are correlated, but not those of [prior]",
                              name(pair.first), name(pair.second)),
          .evidence = fmt::format("correlation {:.2f} (fine up to {:.2g}), p = {:.1g}", correlation,
                                  grave, p_value),
          .advice = "Draw each parameter by itself"},
         std::abs(correlation) > grave);
  }

  // (D, D); 0 of a column that is constant.
  RowMatrix correlations() const {
    constexpr double rounding = 1e-9;
    const RowMatrix f = prior_.to_normal(theta_).unaryExpr([](double u) { return normal_cdf(u); });
    RowMatrix centered = f.rowwise() - f.colwise().mean().eval();
    for (Index d = 0; d < centered.cols(); ++d) {
      const bool is_constant = centered.col(d).cwiseAbs().maxCoeff() < rounding;
      centered.col(d) /= is_constant ? kInfinity : centered.col(d).norm();
    }
    return centered.transpose() * centered;
  }

  // (D, D): of two parameters as many draws as of the one that has more, but not more than rows
  // that differ; 0 of too few.
  RowMatrix roots_of_draws() const {
    constexpr Index fewest = 20;
    RowMatrix roots(theta_.cols(), theta_.cols());
    for (Index d = 0; d < roots.rows(); ++d) {
      for (Index e = 0; e < roots.cols(); ++e) {
        const Index most = std::max(columns_[static_cast<std::size_t>(d)].num_draws,
                                    columns_[static_cast<std::size_t>(e)].num_draws);
        const Index n = std::min(most, num_different_);
        roots(d, e) = n < fewest ? 0.0 : std::sqrt(static_cast<double>(n));
      }
    }
    return roots;
  }

  const RowMatrix& theta_;
  const inference::Prior& prior_;
  std::vector<Column> columns_;
  Index num_different_ = 0;  // rows
  Findings found_;
};

}  // namespace

Findings find_in_theta(const RowMatrix& theta, const inference::Prior& prior) {
  return Inspection(theta, prior).inspect();
}

}  // namespace npdr::pipeline
