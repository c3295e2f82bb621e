#include "inference/diagnostics/excess_width.h"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "core/error.h"
#include "core/normal.h"

namespace npdr::inference {
namespace {

constexpr Index kFolds = 5;
constexpr double kDeviations = 3.0;  // of a share that are taken off it
constexpr Index kComponents = 3;
constexpr Index kMostFeatures = 2000;
constexpr Index kMostDraws = 1000;  // 50 MB of scores and squares

// Phi^-1 of ranks, with a mean of 0; 0 of a column that is the same in all rows. Equal values have
// the mean of their scores.
template <class Column>
Vector normal_scores(const Column& values) {
  const Index n = values.size();
  std::vector<Index> order(static_cast<std::size_t>(n));
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return values(i); });
  const auto at = [&](Index rank) { return order[static_cast<std::size_t>(rank)]; };
  Vector scores(n);
  for (Index begin = 0, end = 0; begin < n; begin = end) {
    double sum = 0.0;
    for (; end < n && values(at(end)) == values(at(begin)); ++end) {
      sum += normal_quantile((static_cast<double>(end) + 0.5) / static_cast<double>(n));
    }
    for (Index k = begin; k < end; ++k) scores(at(k)) = sum / static_cast<double>(end - begin);
  }
  return scores;
}

// Of features spread over those that there are, whatever their period.
RowMatrix scores_of(const RowMatrixF& x) {
  RowMatrix scores(x.rows(), std::min(x.cols(), kMostFeatures));
  const Index step = scores.cols() > 0 ? x.cols() / scores.cols() : 1;
  for (Index f = 0; f < scores.cols(); ++f) {
    scores.col(f) = normal_scores(x.col(f * step + f % step));
  }
  return scores;
}

RowMatrix with_squares(const RowMatrix& scores) {
  RowMatrix both(scores.rows(), 2 * scores.cols());
  both << scores, scores.cwiseAbs2();
  for (Index f = scores.cols(); f < both.cols(); ++f) {
    both.col(f).array() -= both.col(f).mean();
    const double deviation =
        std::sqrt(both.col(f).squaredNorm() / static_cast<double>(both.rows()));
    if (deviation > 0.0) both.col(f) /= deviation;
  }
  return both;
}

std::vector<Index> rows_of_fold(Index n, Index fold, bool are_held_out) {
  std::vector<Index> rows;
  for (Index i = 0; i < n; ++i) {
    if ((i % kFolds == fold) == are_held_out) rows.push_back(i);
  }
  return rows;
}

// Rows of a matrix, less their mean.
RowMatrix centered(const RowMatrix& values, const std::vector<Index>& rows) {
  const RowMatrix some = values(rows, Eigen::all);
  return some.rowwise() - some.colwise().mean();
}

// What regressions with 1, 2, ... components leave of each column of y (n, D) in rows that they
// haven't learned from, sums of squares (kComponents, D). Their scores span X w, X (X^T X) w, ...
// of the weights w = X^T y (Helland 1988).
RowMatrix left_by_regressions(const RowMatrix& x, const RowMatrix& y, Index fold) {
  const std::vector<Index> learned = rows_of_fold(y.rows(), fold, false);
  const std::vector<Index> held_out = rows_of_fold(y.rows(), fold, true);
  const RowMatrix inputs = centered(x, learned), outputs = centered(y, learned);
  const RowMatrix others =
      x(held_out, Eigen::all).rowwise() - x(learned, Eigen::all).colwise().mean().eval();
  const RowMatrix truths =
      y(held_out, Eigen::all).rowwise() - y(learned, Eigen::all).colwise().mean().eval();
  std::vector<RowMatrix> scores, of_others;  // (n, D) of each component
  RowMatrix from = outputs;
  for (Index k = 0; k < kComponents; ++k) {
    RowMatrix weights = inputs.transpose() * from;
    for (Index d = 0; d < weights.cols(); ++d) weights.col(d).stableNormalize();
    scores.emplace_back(inputs * weights);
    of_others.emplace_back(others * weights);
    from = scores.back();
  }
  RowMatrix left(kComponents, y.cols());
  for (Index d = 0; d < y.cols(); ++d) {
    for (Index k = 1; k <= kComponents; ++k) {
      RowMatrix of_learned(inputs.rows(), k), of_held_out(others.rows(), k);
      for (Index j = 0; j < k; ++j) {
        of_learned.col(j) = scores[static_cast<std::size_t>(j)].col(d);
        of_held_out.col(j) = of_others[static_cast<std::size_t>(j)].col(d);
      }
      const Vector slopes = of_learned.completeOrthogonalDecomposition().solve(outputs.col(d));
      left(k - 1, d) = (truths.col(d) - of_held_out * slopes).squaredNorm();
    }
  }
  return left;
}

// R^2 of the best number of components, (D).
Vector explained_by_components(const RowMatrix& x, const RowMatrix& y) {
  RowMatrix left = RowMatrix::Zero(kComponents, y.cols());
  for (Index fold = 0; fold < kFolds; ++fold) left += left_by_regressions(x, y, fold);
  return 1.0 - left.colwise().minCoeff().transpose().array() /
                   y.colwise().squaredNorm().transpose().array();
}

// Sums over held-out rows of the products of two scores with y, of both, and of y with itself,
// (4, D).
using Products = Eigen::Array<double, 4, Eigen::Dynamic>;

// Rows are dealt out anew each time: to folds, and to halves of what a fold doesn't hold.
Products products_of(const RowMatrix& x, const RowMatrix& y, Index deal, Index fold) {
  std::array<std::vector<Index>, 3> parts;  // two halves, the fold
  for (Index i = 0; i < y.rows(); ++i) {
    const Index k = (i + deal * (i / (2 * kFolds))) % (2 * kFolds);
    parts[static_cast<std::size_t>(k / 2 == fold ? 2 : k % 2)].push_back(i);
  }
  const RowMatrix held_out = centered(x, parts[2]), truths = centered(y, parts[2]);
  std::array<RowMatrix, 2> scores;
  for (std::size_t half = 0; half < 2; ++half) {
    const RowMatrix inputs = x(parts[half], Eigen::all);
    scores[half] = held_out * (inputs.transpose() * centered(y, parts[half])).eval();
  }
  Products products(4, y.cols());
  products << scores[0].cwiseProduct(truths).colwise().sum().array(),
      scores[1].cwiseProduct(truths).colwise().sum().array(),
      scores[0].cwiseProduct(scores[1]).colwise().sum().array(),
      truths.colwise().squaredNorm().array();
  return products;
}

Vector share_of(const Products& sums) {
  return (sums.row(2) > 0.0)
      .select(sums.row(0) * sums.row(1) / (sums.row(2) * sums.row(3)), 0.0)
      .transpose();
}

// R^2 of the first component, were its weights learned from any number of draws: those of halves
// differ by errors of their own, which their scores' product doesn't know. Less three times its
// standard error (jackknife over folds). (D)
Vector explained_by_halves(const RowMatrix& x, const RowMatrix& y) {
  constexpr Index deals = 4;
  std::array<Products, kFolds> of_folds;
  Products all = Products::Zero(4, y.cols());
  for (Index fold = 0; fold < kFolds; ++fold) {
    Products& sums = of_folds[static_cast<std::size_t>(fold)] = Products::Zero(4, y.cols());
    for (Index deal = 0; deal < deals; ++deal) sums += products_of(x, y, deal, fold);
    all += sums;
  }
  RowMatrix without(kFolds, y.cols());
  for (Index fold = 0; fold < kFolds; ++fold) {
    without.row(fold) = share_of(all - of_folds[static_cast<std::size_t>(fold)]).transpose();
  }
  const Vector variance =
      (without.rowwise() - without.colwise().mean().eval()).colwise().squaredNorm().transpose() *
      (static_cast<double>(kFolds - 1) / static_cast<double>(kFolds));
  return share_of(all).cwiseMin(1.0) - kDeviations * variance.cwiseSqrt();
}

}  // namespace

Vector excess_width(const RowMatrix& theta, const RowMatrixF& x) {
  if (theta.rows() != x.rows()) {
    throw ShapeError("excess width: " + std::to_string(theta.rows()) + " parameters and " +
                     std::to_string(x.rows()) + " simulations, must be as many");
  }
  if (theta.rows() < kFewestForWidth) {
    throw InputError("excess width: " + std::to_string(theta.rows()) + " draws, must be " +
                     std::to_string(kFewestForWidth) + " or more");
  }
  if (!theta.allFinite() || !x.allFinite()) {
    throw InputError("excess width: parameters and simulations must be finite");
  }
  const Index n = std::min(theta.rows(), kMostDraws);
  const RowMatrix scores = scores_of(x.topRows(n)), squares = with_squares(scores);
  RowMatrix y(n, theta.cols());
  for (Index d = 0; d < y.cols(); ++d) y.col(d) = normal_scores(theta.col(d).head(n));
  const Vector share = explained_by_components(scores, y)
                           .cwiseMax(explained_by_components(squares, y))
                           .cwiseMax(explained_by_halves(scores, y))
                           .cwiseMax(explained_by_halves(squares, y));
  Vector width = Vector::Zero(y.cols());
  for (Index d = 0; d < y.cols(); ++d) {
    if (y.col(d).isZero()) continue;
    width(d) = std::sqrt(std::max(share(d), 0.0) / std::max(1.0 - share(d), 1e-12));
  }
  return width;
}

}  // namespace npdr::inference
