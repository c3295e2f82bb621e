#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/normal.h"
#include "inference/diagnostics/finite_rows.h"
#include "inference/diagnostics/row_faults.h"
#include "inference/diagnostics/uniformity.h"

namespace npdr::inference {
namespace {

constexpr double kFalseAlarmRate = 1e-4, kOrdered = 0.01;
constexpr Index kFewestRows = 48, kShortest = 8, kMostColumns = 20;
constexpr Index kMostParameters = 8, kRowsPerCoefficient = 10;

// From 0 to 1, of equal values their mean.
Vector ranks_of(const Vector& values) {
  std::vector<Index> order(static_cast<std::size_t>(values.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return values(i); });
  Vector ranks(values.size());
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    while (end < order.size() && !(values(order[end]) > values(order[begin]))) ++end;
    const double mean = 0.5 * static_cast<double>(begin + end) / static_cast<double>(order.size());
    for (std::size_t k = begin; k < end; ++k) ranks(order[k]) = mean;
  }
  return ranks;
}

Vector normal_scores(const Vector& values) { return ranks_of(values).unaryExpr(&normal_quantile); }

// Columns of x that vary, evenly chosen.
RowMatrix scores_of(const RowMatrixF& x) {
  const std::vector<Index> varying = varying_columns_of(x);
  const Index count = std::min(std::ssize(varying), kMostColumns);
  RowMatrix scores(x.rows(), count);
  for (Index c = 0; c < count; ++c) {
    const auto chosen = static_cast<std::size_t>(c * std::ssize(varying) / count);
    scores.col(c) = normal_scores(x.col(varying[chosen]).cast<double>());
  }
  return scores;
}

// 1, u_d, and u_d^2 and u_d u_e where rows are enough.
RowMatrix basis_of(const RowMatrix& u) {
  const Index n = u.rows(), d = u.cols(), most = n / kRowsPerCoefficient;
  const bool has_squares = 1 + 2 * d <= most;
  const bool has_products = d <= kMostParameters && 1 + 2 * d + d * (d - 1) / 2 <= most;
  RowMatrix basis(n, 1 + d * (has_squares ? 2 : 1) + (has_products ? d * (d - 1) / 2 : 0));
  basis.col(0).setOnes();
  basis.middleCols(1, d) = u;
  if (has_squares) basis.middleCols(1 + d, d) = u.cwiseAbs2();
  Index next = 1 + 2 * d;
  for (Index i = 0; has_products && i < d; ++i) {
    for (Index j = i + 1; j < d; ++j) basis.col(next++) = u.col(i).cwiseProduct(u.col(j));
  }
  return basis;
}

// Of each row the mean squared residual, and the residual of each column and its square,
// (n, 1 + 2 C).
RowMatrix statistics_of(const RowMatrix& u, const RowMatrix& y) {
  constexpr double ridge = 1e-9;
  const RowMatrix basis = basis_of(u);
  Eigen::MatrixXd gram = basis.transpose() * basis;
  gram.diagonal().array() += ridge * gram.diagonal().maxCoeff();
  RowMatrix residuals = y - basis * gram.ldlt().solve(basis.transpose() * y);
  for (Index c = 0; c < residuals.cols(); ++c) {
    const double deviation = std::sqrt(residuals.col(c).array().square().mean());
    if (deviation > 0.0) residuals.col(c) /= deviation;
  }
  RowMatrix statistics(y.rows(), 1 + 2 * y.cols());
  statistics << residuals.rowwise().squaredNorm(), residuals, residuals.cwiseAbs2();
  return statistics;
}

// Rows of the same theta that follow each other, as one.
RowMatrix means_of_runs(const std::vector<Index>& begins, const RowMatrix& values) {
  RowMatrix means(std::ssize(begins) - 1, values.cols());
  for (Index i = 0; i < means.rows(); ++i) {
    const Index begin = begins[static_cast<std::size_t>(i)];
    const Index count = begins[static_cast<std::size_t>(i) + 1] - begin;
    means.row(i) = values.middleRows(begin, count).colwise().mean();
  }
  return means;
}

// How many rows each is of.
RowMatrix counts_of_runs(const std::vector<Index>& begins) {
  RowMatrix counts(std::ssize(begins) - 1, 1);
  for (Index i = 0; i < counts.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    counts(i, 0) = static_cast<double>(begins[at + 1] - begins[at]);
  }
  return counts;
}

std::vector<Index> begins_of_runs(const RowMatrix& theta) {
  std::vector<Index> begins = {0};
  for (Index i = 1; i < theta.rows(); ++i) {
    if (theta.row(i) != theta.row(i - 1)) begins.push_back(i);
  }
  begins.push_back(theta.rows());
  return begins;
}

// Centered ranks of exchangeable rows, and sums over windows.
class Ranks {
 public:
  explicit Ranks(const Vector& values) : ranks_(ranks_of(values)), sums_(values.size() + 1) {
    sums_(0) = 0.0;
    for (Index i = 0; i < ranks_.size(); ++i) sums_(i + 1) = sums_(i) + ranks_(i) - 0.5;
    variance_ = (ranks_.array() - 0.5).square().mean();
  }

  double mean(Index begin, Index count) const { return 0.5 + sum(begin, count) / double(count); }

  double z(Index begin, Index count) const {
    const auto n = static_cast<double>(ranks_.size()), k = static_cast<double>(count);
    const double variance = variance_ * k * (n - k) / (n - 1.0);
    return variance > 0.0 ? sum(begin, count) / std::sqrt(variance) : 0.0;
  }

  // Of neighbors that are `lag` apart, in deviations of what has no order.
  double correlation(Index lag) const {
    const Index count = ranks_.size() - lag;
    if (!(variance_ > 0.0)) return 0.0;
    const auto centered = ranks_.array() - 0.5;
    return (centered.head(count) * centered.tail(count)).sum() /
           (variance_ * std::sqrt(static_cast<double>(count)));
  }

  Index size() const { return ranks_.size(); }

 private:
  double sum(Index begin, Index count) const { return sums_(begin + count) - sums_(begin); }

  Vector ranks_, sums_;
  double variance_ = 0.0;
};

struct Scan {
  RowStretch most;
  double z = 0.0;
  Index num_windows = 0;

  void look_at(const Ranks& ranks, Index begin, Index count) {
    const double found = std::abs(ranks.z(begin, count));
    if (found <= z) return;
    z = found;
    most = {.begin = begin, .count = count, .mean_rank = ranks.mean(begin, count)};
  }
};

Scan scan(const Ranks& ranks) {
  Scan found;
  for (Index count = kShortest; 2 * count <= ranks.size(); count *= 2) {
    for (Index end = ranks.size(); end >= count; end -= count / 2) {
      found.look_at(ranks, end - count, count);
      ++found.num_windows;
    }
  }
  return found;
}

// Ends near those of the window that deviate more.
RowStretch with_better_ends(const Ranks& ranks, const Scan& rough) {
  constexpr Index steps = 32;
  const auto [begin, count, mean_rank, p_value] = rough.most;
  const Index step = std::max<Index>(1, count / steps);
  Scan best = rough;
  for (Index b = std::max<Index>(0, begin - count); b < begin + count; b += step) {
    const Index last = std::min(begin + 2 * count, ranks.size());
    for (Index end = last; end >= b + kShortest; end -= step) best.look_at(ranks, b, end - b);
  }
  best.most.p_value = p_value;
  return best.most;
}

double p_value_of(double z, Index num_tests) {
  return corrected(std::erfc(z * std::sqrt(0.5)), num_tests);
}

bool has_order(const RowMatrix& u) {
  double largest = 0.0;
  Index num_tests = 0;
  for (Index d = 0; d < u.cols(); ++d) {
    const Ranks ranks(u.col(d));
    const Scan found = scan(ranks);
    largest = std::max(largest, found.z);
    num_tests += found.num_windows;
    for (const Index lag : {1, 2, 3, 5, 10, 20}) {
      if (2 * lag >= ranks.size()) break;
      largest = std::max(largest, std::abs(ranks.correlation(lag)));
      ++num_tests;
    }
  }
  return p_value_of(largest, num_tests) < kOrdered;
}

}  // namespace

std::optional<RowStretch> find_stretch(const RowMatrix& theta, const RowMatrixF& x) {
  const FiniteRows rows(theta, x);
  if (std::ssize(rows.numbers) < kFewestRows) return std::nullopt;
  const std::vector<Index> varying = varying_columns_of(rows.theta);
  if (varying.empty()) return std::nullopt;
  RowMatrix u = rows.theta(Eigen::all, varying);
  const std::vector<Index> begins = begins_of_runs(u);
  if (std::ssize(begins) <= kFewestRows) return std::nullopt;
  for (Index d = 0; d < u.cols(); ++d) u.col(d) = normal_scores(u.col(d));
  const RowMatrix y = scores_of(rows.x);
  const bool has_enough = (1 + u.cols()) * kRowsPerCoefficient <= u.rows();
  if (y.cols() == 0 || !has_enough || has_order(means_of_runs(begins, u))) return std::nullopt;
  // Means of more rows scatter less.
  const RowMatrix counts = counts_of_runs(begins);
  if (counts.maxCoeff() > counts.minCoeff() && has_order(counts)) return std::nullopt;
  const RowMatrix statistics = means_of_runs(begins, statistics_of(u, y));
  Scan found;
  for (Index c = 0; c < statistics.cols(); ++c) {
    const Ranks ranks(statistics.col(c));
    Scan of_one = scan(ranks);
    found.num_windows += of_one.num_windows;
    if (of_one.z <= found.z) continue;
    of_one.num_windows = found.num_windows;
    found = of_one;
    found.most = with_better_ends(ranks, of_one);
  }
  found.most.p_value = p_value_of(found.z, found.num_windows);
  if (found.most.p_value >= kFalseAlarmRate) return std::nullopt;
  const auto row = [&](Index run) {
    return rows.numbers[static_cast<std::size_t>(begins[static_cast<std::size_t>(run)])];
  };
  const Index last_run = found.most.begin + found.most.count - 1;
  const Index last =
      rows.numbers[static_cast<std::size_t>(begins[static_cast<std::size_t>(last_run) + 1] - 1)];
  found.most.begin = row(found.most.begin);
  found.most.count = last + 1 - found.most.begin;
  return found.most;
}

}  // namespace npdr::inference
