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
  if (column.prior.is_unbounded()) return false;
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

std::string advice_at_the_ends(const Column& column) {
  if (!has_steps(column)) return "draw it from the prior, or leave these rows out";
  MarginalFit fit;
  fit.observe(column.values);
  const Marginal around = fit.likeliest();
  return fmt::format(
      "values on a grid stand for those around them, which prior.{} = {{ {} = [{:.6g}, {:.6g}] }} "
      "holds",
      column.prior.name, name_of(around.kind), around.a, around.b);
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
      const bool lies_at_an_end = find_values_at_the_ends(column);
      find_another_prior(column);
      if (!lies_at_an_end) find_frequent_value(column);
    }
    find_correlation();
    return std::move(found_);
  }

 private:
  void tell(std::string fault, bool is_grave) {
    found_.push_back(
        {.severity = is_grave ? Severity::wrong : Severity::suspicious, .what = std::move(fault)});
  }

  void tell_constant(const Column& column) {
    tell(fmt::format("{} of the dataset is {} in all rows: networks learn that value, whatever x "
                     "is; leave it out of [prior]",
                     column.prior.name, column.values(0)),
         true);
  }

  // At the one that has more.
  bool find_values_at_the_ends(const Column& column) {
    const auto &lowest = *column.levels.begin(), &highest = *column.levels.rbegin();
    const bool is_lowest_first = lowest.second >= highest.second;
    return tell_end(column, is_lowest_first ? lowest : highest) ||
           tell_end(column, is_lowest_first ? highest : lowest);
  }

  bool tell_end(const Column& column, const inference::Levels::value_type& level) {
    constexpr double least = 0.02, grave = 0.075;
    constexpr Index fewest = 5;  // draws have an extreme, too, which bounds may be taken from
    const double share = share_of(column, level);
    if (share < least || level.second < fewest) return false;
    const bool is_bound = lies_on_a_bound(column, level.first);
    if (!is_bound && !looks_clipped(column, share)) return false;
    tell(fmt::format("{:.2g} of {} in the dataset are {:.6g}, {}, where a posterior's density is "
                     "cut: {}",
                     share, column.prior.name, level.first,
                     is_bound ? fmt::format("an end of its prior, [{}, {}]", column.prior.lower(),
                                            column.prior.upper())
                              : "an end of it, as if clipped",
                     advice_at_the_ends(column)),
         share > grave);
    return true;
  }

  void find_another_prior(const Column& column) {
    constexpr double grave = 0.05;
    const double distance = inference::distance_of_levels(column.levels, column.prior);
    const double p_value =
        inference::p_value_of_levels(column.levels, column.prior, column.num_draws);
    if (inference::corrected(p_value, theta_.cols()) >= kFalseAlarmRate) return;
    tell(fmt::format(
             "{} of the dataset isn't distributed as the prior says "
             "(their distribution functions differ by {:.2g}, p = {:.1g}): posteriors are those of "
             "the distribution that it was drawn from; ignore this if you mean that one",
             column.prior.name, distance, p_value),
         distance > grave);
  }

  // Networks learn single values. Those of an even grid keep them from it.
  void find_frequent_value(const Column& column) {
    constexpr double least = 0.15, times_usual = 2.0;
    constexpr std::size_t few = 5;
    const auto& most =
        *std::ranges::max_element(column.levels, {}, &inference::Levels::value_type::second);
    const double share = share_of(column, most);
    const bool is_usual = share * static_cast<double>(column.levels.size()) < times_usual;
    if (share < least || (column.levels.size() >= few && is_usual)) return;
    tell(fmt::format("{:.2g} of {} in the dataset are {:.6g}: its posterior may peak at values "
                     "that many rows have, and is made up between them; spread them over the steps "
                     "that they stand for",
                     share, column.prior.name, most.first),
         false);
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
    tell(fmt::format("{} and {} of the dataset are correlated ({:.2f} between F of them, p = "
                     "{:.1g}), and the prior draws each by itself: posteriors are those of the "
                     "distribution that theta was drawn from; ignore this if you mean that one",
                     prior_.marginals()[static_cast<std::size_t>(pair.first)].name,
                     prior_.marginals()[static_cast<std::size_t>(pair.second)].name, correlation,
                     p_value),
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
