#include "inference/diagnostics/excess_width.h"

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
constexpr Index kMostFeatures = 2000;  // 100 MB of scores and squares, with 1000 draws

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

// Of features evenly spaced among those that there are.
RowMatrix scores_of(const RowMatrixF& x) {
  RowMatrix scores(x.rows(), std::min(x.cols(), kMostFeatures));
  for (Index f = 0; f < scores.cols(); ++f) {
    scores.col(f) = normal_scores(x.col(f * x.cols() / scores.cols()));
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

// What regressions with 1, 2, ... components leave of y in rows that they haven't learned from, a
// sum of squares each, (kComponents).
Vector left_by_regression(const RowMatrix& x, const Vector& y, Index fold) {
  const std::vector<Index> learned = rows_of_fold(y.size(), fold, false);
  const std::vector<Index> held_out = rows_of_fold(y.size(), fold, true);
  RowMatrix inputs = x(learned, Eigen::all), others = x(held_out, Eigen::all);
  Vector output = y(learned);
  const Eigen::RowVectorXd center = inputs.colwise().mean();
  const double mean = output.mean();
  inputs.rowwise() -= center;
  others.rowwise() -= center;
  output.array() -= mean;
  Vector error = y(held_out).array() - mean;
  Vector left(kComponents);
  for (Index k = 0; k < kComponents; ++k) {
    const Vector weights = (inputs.transpose() * output).stableNormalized();
    const Vector score = inputs * weights;
    const double size = score.squaredNorm();
    if (size > 0.0) {
      const Vector loading = inputs.transpose() * score / size;
      const double slope = score.dot(output) / size;
      const Vector of_others = others * weights;
      inputs.noalias() -= score * loading.transpose();
      others.noalias() -= of_others * loading.transpose();
      output -= slope * score;
      error -= slope * of_others;
    }
    left(k) = error.squaredNorm();
  }
  return left;
}

// R^2 of the best number of components.
double explained_by_components(const RowMatrix& x, const Vector& y) {
  Vector left = Vector::Zero(kComponents);
  for (Index fold = 0; fold < kFolds; ++fold) left += left_by_regression(x, y, fold);
  return 1.0 - left.minCoeff() / y.squaredNorm();
}

// Sums over held-out rows of the products of two scores with y, of both, and of y with itself.
using Products = Eigen::Array4d;

double share_of(const Products& sums) {
  return sums(2) > 0.0 ? sums(0) * sums(1) / (sums(2) * sums(3)) : 0.0;
}

// Rows are dealt out anew each time: to folds, and to halves of what a fold doesn't hold.
Products products_of(const RowMatrix& x, const Vector& y, Index deal, Index fold) {
  std::array<std::vector<Index>, 3> parts;  // two halves, the fold
  for (Index i = 0; i < y.size(); ++i) {
    const Index k = (i + deal * (i / (2 * kFolds))) % (2 * kFolds);
    parts[static_cast<std::size_t>(k / 2 == fold ? 2 : k % 2)].push_back(i);
  }
  const auto centered = [](auto values) {
    return (values.rowwise() - values.colwise().mean().eval()).eval();
  };
  const RowMatrix held_out = centered(x(parts[2], Eigen::all).eval());
  const RowMatrix truth = centered(RowMatrix(y(parts[2])));
  std::array<Vector, 2> scores;
  for (std::size_t half = 0; half < 2; ++half) {
    const RowMatrix output = centered(RowMatrix(y(parts[half])));
    scores[half] = held_out * (x(parts[half], Eigen::all).transpose() * output).col(0);
  }
  return {scores[0].dot(truth.col(0)), scores[1].dot(truth.col(0)), scores[0].dot(scores[1]),
          truth.squaredNorm()};
}

// R^2 of the first component, were its weights learned from any number of draws: those of halves
// differ by errors of their own, which their scores' product doesn't know. Less three times its
// standard error (jackknife over folds).
double explained_by_halves(const RowMatrix& x, const Vector& y) {
  constexpr Index deals = 4;
  std::array<Products, kFolds> of_folds;
  Products all = Products::Zero();
  for (Index fold = 0; fold < kFolds; ++fold) {
    Products& sums = of_folds[static_cast<std::size_t>(fold)] = Products::Zero();
    for (Index deal = 0; deal < deals; ++deal) sums += products_of(x, y, deal, fold);
    all += sums;
  }
  Vector without(kFolds);
  for (Index fold = 0; fold < kFolds; ++fold) {
    without(fold) = share_of(all - of_folds[static_cast<std::size_t>(fold)]);
  }
  const double variance = (without.array() - without.mean()).square().sum() *
                          static_cast<double>(kFolds - 1) / static_cast<double>(kFolds);
  return std::min(share_of(all), 1.0) - kDeviations * std::sqrt(variance);
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
  const RowMatrix scores = scores_of(x), squares = with_squares(scores);
  Vector width = Vector::Zero(theta.cols());
  for (Index d = 0; d < theta.cols(); ++d) {
    const Vector y = normal_scores(theta.col(d));
    if (y.isZero()) continue;
    const double share =
        std::max({explained_by_components(scores, y), explained_by_components(squares, y),
                  explained_by_halves(scores, y), explained_by_halves(squares, y)});
    width(d) = std::sqrt(std::max(share, 0.0) / std::max(1.0 - share, 1e-12));
  }
  return width;
}

}  // namespace npdr::inference
