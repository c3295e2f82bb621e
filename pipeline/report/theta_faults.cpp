#include "pipeline/report/theta_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/normal.h"
#include "inference/diagnostics/levels.h"
#include "inference/diagnostics/uniformity.h"
#include "pipeline/report/correlated_pair.h"
#include "pipeline/sources/marginal_fit.h"

namespace npdr::pipeline {
namespace {

using inference::Marginal;

constexpr double kFalseAlarmRate = 1e-4;

Index num_different_rows(const RowMatrix& theta) {
  std::set<std::vector<double>> rows;
  for (Index i = 0; i < theta.rows(); ++i) rows.emplace(theta.row(i).begin(), theta.row(i).end());
  return std::ssize(rows);
}

// One parameter of all rows.
struct Column {
  const Marginal& prior;
  Vector values;
  inference::Levels levels;
  Index num_draws = 0;  // that are independent
};

// The share of the column at an end of its prior, the larger of both.
double share_at_the_ends(const Column& column) {
  constexpr double end = 1e-6;
  constexpr Index fewest = 5;  // draws have an extreme, too, which bounds may be taken from
  if (column.prior.is_unbounded()) return 0.0;
  const Vector u = inference::Prior({column.prior}).to_normal(column.values).col(0);
  const double farthest = -normal_quantile(end);
  const Index most = std::max((u.array() < -farthest).count(), (u.array() > farthest).count());
  return most < fewest ? 0.0 : static_cast<double>(most) / static_cast<double>(u.size());
}

std::string advice_at_the_ends(const Column& column) {
  constexpr std::size_t few = 20;
  if (column.levels.size() > few && !inference::is_grid(column.levels)) {
    return "draw it from the prior, or leave these rows out";
  }
  MarginalFit fit;
  fit.observe(column.values);
  const Marginal around = fit.likeliest();
  return fmt::format(
      "values on a grid stand for those around them, which prior.{} = {{ {} = [{:.6g}, {:.6g}] }} "
      "holds",
      column.prior.name, name_of(around.kind), around.a, around.b);
}

class Inspection {
 public:
  Inspection(const RowMatrix& theta, const inference::Prior& prior) : theta_(theta), prior_(prior) {
    const Index num_different = num_different_rows(theta);
    for (Index d = 0; d < theta.cols(); ++d) {
      const inference::Levels levels = inference::levels_of(theta.col(d));
      columns_.push_back({prior.marginals()[static_cast<std::size_t>(d)], theta.col(d), levels,
                          inference::are_chosen(levels) ? num_different : std::ssize(levels)});
    }
  }

  DatasetFaults inspect() {
    for (const Column& column : columns_) {
      if (column.levels.size() == 1) {
        tell_constant(column);
        continue;
      }
      find_values_at_the_ends(column);
      find_another_prior(column);
      find_few_values(column);
    }
    find_correlation();
    return std::move(found_);
  }

 private:
  void tell(std::string fault, bool is_grave) {
    found_.faults.push_back(std::move(fault));
    found_.are_grave |= is_grave;
  }

  void tell_constant(const Column& column) {
    tell(fmt::format("{} of the dataset is {} in all rows: networks learn that value, whatever x "
                     "is; leave it out of [prior]",
                     column.prior.name, column.values(0)),
         true);
  }

  void find_values_at_the_ends(const Column& column) {
    constexpr double least = 0.02, grave = 0.075;
    const double share = share_at_the_ends(column);
    if (share < least) return;
    tell(fmt::format("{:.2g} of {} in the dataset lie at an end of its prior, [{}, {}], "
                     "where a posterior's density is cut: {}",
                     share, column.prior.name, column.prior.lower(), column.prior.upper(),
                     advice_at_the_ends(column)),
         share > grave);
  }

  void find_another_prior(const Column& column) {
    constexpr double grave = 0.05;
    const double distance = inference::distance_of_levels(column.levels, column.prior);
    const double p_value = inference::kolmogorov_smirnov_p_value(distance, column.num_draws);
    if (inference::corrected(p_value, theta_.cols()) >= kFalseAlarmRate) return;
    tell(fmt::format("{} of the dataset isn't distributed as the prior says "
                     "(Kolmogorov-Smirnov {:.2f}, p = {:.1g}): where its theta wasn't drawn "
                     "from this prior, posteriors are those of another one",
                     column.prior.name, distance, p_value),
         distance > grave);
  }

  void find_few_values(const Column& column) {
    constexpr std::size_t few = 5;
    if (column.levels.size() >= few) return;
    tell(fmt::format("{} of the dataset has {} different values: what posteriors say of those "
                     "between them is made up",
                     column.prior.name, column.levels.size()),
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
                     "{:.1g}), and the prior draws each by itself: where theta wasn't drawn from "
                     "this prior, posteriors are those of another one",
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
      centered.col(d) /= is_constant ? HUGE_VAL : centered.col(d).norm();
    }
    return centered.transpose() * centered;
  }

  // (D, D): of two parameters as many draws as of the one that has more; 0 of too few.
  RowMatrix roots_of_draws() const {
    constexpr Index fewest = 20;
    RowMatrix roots(theta_.cols(), theta_.cols());
    for (Index d = 0; d < roots.rows(); ++d) {
      for (Index e = 0; e < roots.cols(); ++e) {
        const Index n = std::max(columns_[static_cast<std::size_t>(d)].num_draws,
                                 columns_[static_cast<std::size_t>(e)].num_draws);
        roots(d, e) = n < fewest ? 0.0 : std::sqrt(static_cast<double>(n));
      }
    }
    return roots;
  }

  const RowMatrix& theta_;
  const inference::Prior& prior_;
  std::vector<Column> columns_;
  DatasetFaults found_;
};

}  // namespace

DatasetFaults faults_of_theta(const RowMatrix& theta, const inference::Prior& prior) {
  return Inspection(theta, prior).inspect();
}

}  // namespace npdr::pipeline
