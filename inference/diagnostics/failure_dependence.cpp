#include "inference/diagnostics/failure_dependence.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "inference/diagnostics/tail_probability.h"

namespace npdr::inference {
namespace {

using Rows = std::vector<std::uint32_t>;

// Rows that failed, or those that didn't; of many, a random choice.
Rows rows_that(const std::vector<bool>& failed, bool have_failed, Index most, StreamId id) {
  Rows rows;
  for (std::size_t i = 0; i < failed.size(); ++i) {
    if (failed[i] == have_failed) rows.push_back(static_cast<std::uint32_t>(i));
  }
  if (std::ssize(rows) <= most) return rows;
  id.epoch = have_failed ? 2 : 1;  // 0 is the permutations'
  Rows chosen;
  const auto order = Stream(id).permutation(static_cast<std::uint32_t>(rows.size()));
  for (Index i = 0; i < most; ++i) chosen.push_back(rows[order[static_cast<std::size_t>(i)]]);
  return chosen;
}

std::vector<std::pair<Index, Index>> terms_of(Index dimension, Index most_parameters) {
  std::vector<std::pair<Index, Index>> terms;
  for (Index d = 0; d < dimension; ++d) terms.emplace_back(d, -1);
  for (Index d = 0; d < dimension; ++d) {
    terms.emplace_back(d, d);
    if (dimension > most_parameters) continue;
    for (Index e = d + 1; e < dimension; ++e) terms.emplace_back(d, e);
  }
  return terms;
}

// The terms of each row, standardized, (n, terms).
RowMatrix standardized_terms(const RowMatrix& u,
                             const std::vector<std::pair<Index, Index>>& terms) {
  RowMatrix z(u.rows(), std::ssize(terms));
  for (Index t = 0; t < z.cols(); ++t) {
    const auto [d, e] = terms[static_cast<std::size_t>(t)];
    Eigen::ArrayXd values = u.col(d).array();
    if (e >= 0) values *= u.col(e).array();
    values -= values.mean();
    const double deviation = std::sqrt(values.square().mean());
    z.col(t) = deviation > 0.0 ? (values / deviation).matrix() : Vector(Vector::Zero(u.rows()));
  }
  return z;
}

Eigen::RowVectorXd sum_of(const RowMatrix& z, const Rows& rows, Index count) {
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(z.cols());
  for (Index i = 0; i < count; ++i) sum += z.row(rows[static_cast<std::size_t>(i)]);
  return sum;
}

}  // namespace

FailureDependence test_failures(const RowMatrix& u, const std::vector<bool>& failed,
                                const StreamId& id, const FailureDependenceConfig& config) {
  if (u.rows() != std::ssize(failed) || u.cols() < 1) {
    throw ShapeError("failures: rows of parameters and of outcomes must be as many");
  }
  FailureDependence result;
  result.num_failed = std::ranges::count(failed, true);
  result.num_good = u.rows() - result.num_failed;
  if (result.num_failed == 0 || result.num_good == 0) return result;
  // Of the fewer rows, the sum over which says that over the others.
  const bool fewer_failed = result.num_failed <= result.num_good;
  Rows rows = rows_that(failed, fewer_failed, config.most_rows, id);
  const Rows others = rows_that(failed, !fewer_failed, config.most_rows, id);
  const Index count = std::ssize(rows);
  rows.insert(rows.end(), others.begin(), others.end());
  const auto terms = terms_of(u.cols(), config.most_parameters);
  const RowMatrix z = standardized_terms(u(rows, Eigen::all), terms);

  Vector null(config.num_permutations);
  parallel_for(config.num_permutations, [&](Index p) {
    StreamId of_permutation = id;
    of_permutation.row += static_cast<std::uint64_t>(p);
    const Rows order = Stream(of_permutation).permutation(static_cast<std::uint32_t>(z.rows()));
    null(p) = sum_of(z, order, count).cwiseAbs().maxCoeff();
  });
  const Eigen::RowVectorXd observed = z.topRows(count).colwise().sum();
  const double statistic = observed.cwiseAbs().maxCoeff();
  Index worst = 0;
  if (observed.head(u.cols()).cwiseAbs().maxCoeff(&worst) < 0.5 * statistic) {
    observed.cwiseAbs().maxCoeff(&worst);
  }
  result.term = terms[static_cast<std::size_t>(worst)];
  const double total = static_cast<double>(z.rows()), part = static_cast<double>(count);
  result.shift = (fewer_failed ? 1.0 : -1.0) * observed(worst) / part * total / (total - part);
  // The same rows in another order are the same but for rounding.
  constexpr double rounding = 1e-9;
  result.p_value = tail_probability(null, statistic * (1.0 - rounding));
  return result;
}

}  // namespace npdr::inference
