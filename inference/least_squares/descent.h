/// Levenberg and Marquardt's steps from many starts at once (least_squares.h). Private to
/// inference/least_squares.
#pragma once

#include <functional>
#include <vector>

#include "core/constants.h"
#include "core/types.h"
#include "inference/least_squares/least_squares.h"
#include "inference/least_squares/normal_equations.h"

namespace npdr::inference {

/// A simulated point.
struct Point {
  Vector unknowns;          ///< (D + B C) u, and those of each block
  RowMatrix errors;         ///< (H K, C); empty: it can't be simulated
  Vector scales;            ///< (C)
  double cost = kInfinity;  ///< [nats], with the prior's
};

/// The way of one start.
struct Search {
  Point at;
  NormalEquations normal;
  Vector moves;           ///< (D) of u, of the next differences
  double damping = 1e-2;  ///< relative to the curvature's diagonal
  bool is_done = false;

  auto u() const { return at.unknowns.head(moves.size()); }
  auto own() const { return at.unknowns.tail(at.unknowns.size() - moves.size()); }
};

/// Costs and derivatives by simulations, which are counted.
class Simulations {
 public:
  /// Keeps a reference.
  Simulations(const LeastSquaresProblem& problem, Index max_rows)
      : problem_(problem), max_rows_(max_rows) {}

  const LeastSquaresProblem& problem() const { return problem_; }
  Index num_rows() const { return num_rows_; }
  Index num_failed() const { return num_failed_; }
  /// Rows that may still be simulated.
  Index num_left() const { return max_rows_ - num_rows_; }

  /// visit(i, errors (H K, C)) of each row of unknowns (n, D + B C), in order; no errors of a row
  /// that failed.
  void for_each(const RowMatrix& unknowns, const std::function<void(Index, RowMatrix)>& visit);
  /// Points of rows of unknowns; `guess`: of the scales of row i.
  std::vector<Point> points(const RowMatrix& unknowns, const std::function<Vector(Index)>& guess);
  /// Slopes (H K C, D + C) of errors by u and the unknowns of their block at each search, by
  /// forward differences; 0 where a moved point can't be simulated.
  std::vector<RowMatrix> slopes(const std::vector<Search*>& searches);
  /// The same of one search by central differences, or by one side where the other can't be
  /// simulated.
  RowMatrix central_slopes(Search& search);
  /// Rows that slopes of D parameters take at one side.
  Index rows_of_slopes(Index dimension) const { return dimension + num_own(); }
  /// Rows of u (n, D) with unknowns of blocks that are 0.
  RowMatrix completed(const RowMatrix& u) const;

 private:
  // Unknowns of a block: C, or none.
  Index num_own() const {
    return problem_.block_begins.empty() ? 0 : problem_.noise.num_channels();
  }
  // Of each of the columns of slopes.
  static double move_of(const Search& search, Index column);
  void for_each_moved(const std::vector<Search*>& searches, double factor,
                      const std::function<void(std::size_t, Index, const RowMatrix&)>& visit);
  RowMatrix shaped(const VectorF& row) const;

  const LeastSquaresProblem& problem_;
  Index max_rows_;
  Index num_rows_ = 0, num_failed_ = 0;
  Index most_rows_ = 64;  // of a block, until errors' number is known
};

/// What the cost says of the errors of a point.
WeightedErrors weighted(const StudentErrors& noise, const Point& at, RowMatrix slopes);

/// The `count` rows of u (n, D) with the smallest costs; fewer where fewer can be simulated.
RowMatrix best_rows(Simulations& simulations, const RowMatrix& u, Index count);

/// Rows that a start of D parameters needs for some steps and its curvature.
Index rows_of_start(const Simulations& simulations, Index dimension);

/// The way of each start (k, D) to its minimum, the best first. Of starts that meet the best stays;
/// those that can't be simulated are left out, and the worst where rows aren't left for all.
std::vector<Search> descend(Simulations& simulations, const RowMatrix& starts, Index max_steps);

}  // namespace npdr::inference
