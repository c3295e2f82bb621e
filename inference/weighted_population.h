/// Weighted draws: points x_i of a density q that stand for another one p by weights w_i = p(x_i) /
/// q(x_i), which are known up to a constant, or by their logarithms.
#pragma once

#include <algorithm>
#include <functional>
#include <vector>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

/// (sum w)^2 / sum w^2: how many equally weighted samples tell as much (Kong, Liu and Wong 1994).
double effective_size(const Vector& weights);

/// sum_i w_i x_i / sum w, (D). x: (n, D), weights (n) >= 0.
Vector weighted_mean(const RowMatrix& x, const Vector& weights);

/// sum_i w_i (x_i - mean)(x_i - mean)^T / (sum w - sum w^2 / sum w), (D, D): unbiased, and with
/// equal weights the usual one with n - 1. NaN when one sample has all of the weight.
Eigen::MatrixXd weighted_covariance(const RowMatrix& x, const Vector& weights);

/// weighted_covariance() of points that may be few, or hardly vary in a column: its diagonal is
/// larger by 1e-12 and 1e-9 of itself, which lets it be factored.
Eigen::MatrixXd regularized_covariance(const RowMatrix& x, const Vector& weights);

/// Logarithms, -infinity where they are NaN or infinite.
Vector numbers(const Vector& logs);
/// The largest that is a number; -infinity: none is.
double largest_number(const Vector& logs);
/// exp of logarithms, the largest 1; 0 where a logarithm is no number.
Vector exponentials(const Vector& logs);
/// exponentials(), cut off at their mean times sqrt(n) (Ionides 2008).
Vector truncated(const Vector& logs);

/// The largest power from `low` to `high` that is enough, where all below one that is are, too: by
/// `halvings` of the interval; `low` when none is.
double largest_power(double low, double high, const std::function<bool(double)>& is_enough,
                     int halvings = 60);

/// Some of weighted points: each at most once, with weights of at least 1.
struct Choice {
  std::vector<Index> rows;
  Vector weights;
};
/// About `most` of them. Row i is kept with probability min(1, w_i / c) and then weighs
/// max(1, w_i / c) (rejection control; Liu, Chen and Wong 1998).
Choice choose_rows(const Vector& weights, Index most, const StreamId& id);

/// Share of weighted points' mass that is above a density's reach: of a point whose log ratio r to
/// the density passes `most`, what is above it, 1 - exp(most - r).
double heavy_share(const Vector& weights, const Vector& log_ratios, double most);

/// log Z = log mean w of the weights' logarithms, and its standard error [nats].
struct Evidence {
  double log_value;
  double error;
};
Evidence evidence(const Vector& logs);

/// Draws by inversion of the weights' distribution function. Const calls are thread-safe.
class Resampler {
 public:
  /// weights (n) >= 0, at least one > 0; they need not sum to 1.
  explicit Resampler(const Vector& weights);

  /// The candidate at `uniform` in (0, 1).
  Index draw(double uniform) const;
  /// `count` candidates at (i + uniform) / count, ascending (systematic resampling).
  std::vector<Index> systematic(Index count, double uniform) const;
  double effective_size() const { return effective_size_; }

 private:
  Vector cumulative_;
  double effective_size_;
};

/// Points by logarithms of their weights.
class WeightedPopulation {
 public:
  /// No points of a dimension.
  explicit WeightedPopulation(Index dimension) : points_(0, dimension) {}
  /// points (n, D), log_weights (n) [nats]; NaN weighs nothing.
  WeightedPopulation(RowMatrix points, Vector log_weights);

  void append(const WeightedPopulation& more);

  Index size() const { return log_weights_.size(); }
  const RowMatrix& points() const { return points_; }
  const Vector& log_weights() const { return log_weights_; }

  /// Whether a point weighs something, and none infinitely much: what all of the following need.
  bool has_weight() const;
  /// (n), the largest 1.
  Vector weights() const;
  /// (sum w)^2 / sum w^2 of the weights w, from 1 to n.
  double effective_size() const;
  /// log 1/n sum_i w_i [nats].
  double log_mean_weight() const;
  /// (D), (D, D).
  Vector mean() const;
  Eigen::MatrixXd covariance() const;
  /// The largest of `values` (n), one a point, that points with a share `below` of all weight have
  /// at most.
  double quantile(const Vector& values, double below) const;

  /// (count, D) points by systematic resampling (Kitagawa 1996), in random order.
  RowMatrix resampled(Index count, Stream& stream) const;
  /// (n, D) points, drawn independently: row i with the stream of row id.row + i.
  RowMatrix draw(Index n, StreamId id) const;

 private:
  RowMatrix points_;
  Vector log_weights_;
};

/// (n, D) draws that are made in groups of `group` rows: `draw_group` makes those of a stream of
/// row id.row + the first row's number, whole groups, so that row i depends on `id` and i alone.
template <class DrawGroup>
RowMatrix draw_in_groups(Index n, Index group, Index dimension, const StreamId& id,
                         const DrawGroup& draw_group) {
  RowMatrix draws(n, dimension);
  for (Index first = 0; first < n; first += group) {
    StreamId of_group = id;
    of_group.row += static_cast<std::uint64_t>(first);
    const Index rows = std::min(group, n - first);
    draws.middleRows(first, rows) = draw_group(of_group).topRows(rows);
  }
  return draws;
}

}  // namespace npdr::inference
