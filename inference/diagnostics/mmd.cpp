#include "inference/diagnostics/mmd.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/error.h"
#include "core/matrix_blocking.h"
#include "core/parallel.h"
#include "core/quantile.h"
#include "inference/diagnostics/two_samples.h"

namespace npdr::inference {
namespace {

constexpr Index kTile = 512;

// |a_i - b_j|^2 as differences: products would cancel for rows that are far out.
RowMatrixF squared_distances(const RowMatrixF& a, const RowMatrixF& b) {
  const RowMatrixF columns = b.transpose();
  RowMatrixF result = RowMatrixF::Zero(a.rows(), b.rows());
  for (Index i = 0; i < a.rows(); ++i) {
    for (Index d = 0; d < a.cols(); ++d) {
      result.row(i).array() += (columns.row(d).array() - a(i, d)).square();
    }
  }
  return result;
}

// Median over at most 1000 rows, drawn from the pooled ones: a permutation must not change it.
double median_distance(const RowMatrixF& x, const StreamId& id) {
  constexpr Index most_rows = 1000;
  auto rows = Stream(id).permutation(static_cast<std::uint32_t>(x.rows()));
  rows.resize(static_cast<std::size_t>(std::min(most_rows, x.rows())));
  const RowMatrixF some = x(rows, Eigen::all);
  const RowMatrixF squares = squared_distances(some, some);
  std::vector<float> values;
  for (Index i = 1; i < squares.rows(); ++i) {
    values.insert(values.end(), squares.row(i).begin(), squares.row(i).begin() + i);
  }
  const double median = std::sqrt(static_cast<double>(upper_median(std::move(values))));
  return median > 0.0 ? median : 1.0;  // more than half of the rows are the same
}

// s_p^T K s_p of the columns of `members` (N, P), K without its diagonal: sums of the kernel over
// pairs of members. Tiles above the diagonal count twice.
Vector sums_over_pairs(const RowMatrixF& x, const RowMatrixF& members, double bandwidth) {
  const auto scale = static_cast<float>(-0.5 / (bandwidth * bandwidth));
  const Index n = x.rows(), num_tiles = (n + kTile - 1) / kTile;
  const auto rows_of = [&](Index tile) { return std::min(kTile, n - tile * kTile); };
  RowMatrix sums = RowMatrix::Zero(num_tiles, members.cols());
  parallel_for(num_tiles, [&](Index i) {
    const RowMatrixF x_i = x.middleRows(i * kTile, rows_of(i));
    const RowMatrixF members_i = members.middleRows(i * kTile, rows_of(i));
    RowMatrixF kernel, products;
    for (Index j = i; j < num_tiles; ++j) {
      const RowMatrixF x_j = x.middleRows(j * kTile, rows_of(j));
      kernel = (scale * squared_distances(x_i, x_j).array()).exp();
      if (i == j) kernel.diagonal().setZero();
      products.noalias() = kernel * members.middleRows(j * kTile, rows_of(j));
      const double times = i == j ? 1.0 : 2.0;
      sums.row(i) += times * products.cwiseProduct(members_i).cast<double>().colwise().sum();
    }
  });
  return sums.colwise().sum().transpose();
}

// Membership of rows in the first sample, 1 or 0: as given in column 0, at random in the others.
RowMatrixF deal_rows(Index rows, Index first_rows, Index num_permutations, const StreamId& id) {
  RowMatrixF members = RowMatrixF::Zero(rows, 1 + num_permutations);
  members.col(0).head(first_rows).setOnes();
  for (Index p = 1; p <= num_permutations; ++p) {
    StreamId of_permutation = id;
    of_permutation.row += static_cast<std::uint64_t>(p);
    const auto order = Stream(of_permutation).permutation(static_cast<std::uint32_t>(rows));
    for (Index i = 0; i < first_rows; ++i) members(order[static_cast<std::size_t>(i)], p) = 1.0f;
  }
  return members;
}

}  // namespace

Mmd mmd(const RowMatrix& first, const RowMatrix& second, const StreamId& id,
        const MmdConfig& config) {
  require_two_samples("MMD", first, second);
  if (config.num_permutations < 1) throw InputError("MMD: num_permutations must be >= 1");
  fix_matrix_blocking();
  const RowMatrix both = pooled(first, second);
  const RowMatrixF x = standardized(both, both);
  Mmd result;
  result.bandwidth = median_distance(x, id);
  const RowMatrixF members = deal_rows(both.rows(), first.rows(), config.num_permutations, id);
  const Eigen::ArrayXd in_first = sums_over_pairs(x, members, result.bandwidth);
  const RowMatrixF others = 1.0f - members.array();
  const Eigen::ArrayXd in_second = sums_over_pairs(x, others, result.bandwidth);
  const double total = sums_over_pairs(x, RowMatrixF::Ones(both.rows(), 1), result.bandwidth)(0);
  const auto n = static_cast<double>(first.rows()), m = static_cast<double>(second.rows());
  const Eigen::ArrayXd across = total - in_first - in_second;  // 2 sum_{i, j} k(x_i, y_j)
  const Eigen::ArrayXd squared =
      in_first / (n * (n - 1.0)) + in_second / (m * (m - 1.0)) - across / (n * m);
  const auto as_large = (squared.tail(config.num_permutations) >= squared(0)).count();
  result.squared = squared(0);
  result.p_value =
      (1.0 + static_cast<double>(as_large)) / (1.0 + static_cast<double>(config.num_permutations));
  return result;
}

}  // namespace npdr::inference
