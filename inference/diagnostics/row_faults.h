/// Do rows of theta and x belong together?
///
/// Rows of right simulations are exchangeable: x depends on its own row's theta and on chance. What
/// breaks that is a stretch of rows in another order, unit or version; x that another theta has,
/// too; rows that are there twice; and numbers that stand for a failure. Every test takes theta
/// (n, D) and x (n, F) of the same rows, in the order in which they were made. Rows of x that
/// aren't finite don't count. Throws ShapeError where rows aren't as many.
///
/// Of 17,034 right worlds of 64 to 20,000 rows one was accused, of rare counts, on seeds that no
/// threshold was chosen by (docs/methods.md, "Rows that don't belong together").
#pragma once

#include <optional>
#include <vector>

#include "core/types.h"

namespace npdr::inference {

/// Consecutive rows whose x goes with theta in another way than that of the other rows.
struct RowStretch {
  Index begin = 0, count = 0;  ///< rows, roughly
  double mean_rank = 0.5;      ///< of their residuals among all rows', from 0 to 1; 0.5 is usual
  double p_value = 1.0;        ///< of all windows and statistics (Bonferroni)
};

/// The stretch that deviates most, where its p-value is below 1e-4.
///
/// Normal scores of up to 20 columns of x are regressed on 1, u_d, u_d^2 and u_d u_e of the normal
/// scores u of theta (no products beyond 8 parameters; squares and products need ten rows a
/// coefficient each). Statistics of a row: the mean squared standardized residual, and the residual
/// of each column. Their ranks are summed over windows of 8, 16, ... n/2 rows at half overlap; a
/// sum of ranks of exchangeable rows has a known mean and variance (Wilcoxon 1945). Consecutive
/// rows of the same theta are one. None where theta itself has an order (neighbors in the file
/// correlate, or windows of u deviate, p < 0.01): residuals may then depend on theta. Nor where the
/// numbers of rows of the same theta have one: means of more rows scatter less.
std::optional<RowStretch> find_stretch(const RowMatrix& theta, const RowMatrixF& x);

/// How many rows have an x that another row has, too, to the last bit, though all their parameters
/// that vary differ; 0 where that may be chance (p > 1e-4). Values at an end of their column are
/// taken for clipped, and say nothing; values on a lattice (counts, rounded numbers) agree as often
/// as its step says. Nothing of designs, where x may not depend on all parameters.
Index count_same_rows(const RowMatrix& theta, const RowMatrixF& x);

/// Rows that are there several times, x and theta.
struct RowCopies {
  Index num_rows = 0;     ///< that are finite
  Index num_exact = 0;    ///< beyond the first of each
  double expected = 0.0;  ///< of the exact ones, by how many values each parameter has
  Index num_near = 0;     ///< pairs that differ by less than a thousandth of the usual distance
};

/// Exact copies, none where x of the same theta differs mostly and agrees by chance (counts). Near
/// ones are pairs whose theta are nearer than 1e-3 (1e-4 where a single parameter varies) of the
/// distance to the fifth neighbor, and whose x agree to 1e-4 of the quartiles' distance in every
/// column; none where so many may lie together by chance (p > 1e-4).
RowCopies find_copies(const RowMatrix& theta, const RowMatrixF& x);

/// Numbers in a column that probably stand for a failure.
struct CodedColumn {
  Index column = 0;
  float value = 0.0f;  ///< the outermost
  Index count = 0;
  bool is_exact = true;  ///< all are that value
};

/// Columns of x (n, F) with such numbers: three or more exact ones among values that hardly repeat,
/// or at least 5 and 0.2 % of the values, half of all at most, which lie beyond a gap wider than
/// the range of all other values, within a twentieth of that gap, and half of that range: a mode of
/// its own varies as much as others.
std::vector<CodedColumn> find_codes(const RowMatrixF& x);

}  // namespace npdr::inference
