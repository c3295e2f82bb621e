/// Points that stand for a density p, as weighted draws of another one q: w_i = p(x_i) / q(x_i), up
/// to a constant, by their logarithms.
#pragma once

#include <algorithm>

#include "core/random.h"
#include "core/types.h"

namespace npdr::inference {

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
  /// (sum w)^2 / sum w^2 (weighted_moments.h).
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
