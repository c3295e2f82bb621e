#include "inference/samplers/group_moves.h"

#include <cmath>
#include <utility>
#include <vector>

#include "inference/samplers/step_length.h"

namespace npdr::inference {
namespace {

constexpr double kJitter = 1e-3;  // of each coordinate, out of the span of few rows

using Rows = std::vector<std::uint32_t>;

// Steps of the rows `movers` by differences of `others`.
RowMatrix proposed_steps(const RowMatrix& u, const Rows& movers, const Rows& others,
                         Stream& stream) {
  const auto count = static_cast<std::uint32_t>(others.size());
  const double length = kBestStep / std::sqrt(2.0 * static_cast<double>(u.cols()));
  RowMatrix to(std::ssize(movers), u.cols());
  for (std::size_t i = 0; i < movers.size(); ++i) {
    const std::uint32_t j = stream.below(count);
    const std::uint32_t k = (j + 1 + stream.below(count - 1)) % count;
    const double g = length * std::exp(kSpreadOfSteps * stream.normal());
    auto row = to.row(static_cast<Index>(i));
    row = u.row(movers[i]) + g * (u.row(others[j]) - u.row(others[k]));
    for (double& value : row) value += kJitter * stream.normal();
  }
  return to;
}

}  // namespace

void move_group(RowMatrix& u, const LogDensity& log_density, Index num_sweeps, Stream& stream) {
  const auto n = static_cast<std::uint32_t>(u.rows());
  if (n < 4) return;
  Vector log_p = log_density(u);
  for (Index sweep = 0; sweep < num_sweeps; ++sweep) {
    const Rows order = stream.permutation(n);
    Rows half(order.begin(), order.begin() + n / 2), other(order.begin() + n / 2, order.end());
    for (int turn = 0; turn < 2; ++turn, std::swap(half, other)) {
      const RowMatrix to = proposed_steps(u, half, other, stream);
      const Vector log_p_to = log_density(to);
      for (std::size_t i = 0; i < half.size(); ++i) {
        const auto from = static_cast<Index>(half[i]), row = static_cast<Index>(i);
        if (!(std::log(stream.uniform()) < log_p_to(row) - log_p(from))) continue;
        u.row(from) = to.row(row);
        log_p(from) = log_p_to(row);
      }
    }
  }
}

}  // namespace npdr::inference
