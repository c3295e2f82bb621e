#include "inference/samplers/chain_diagnostics.h"

#include <algorithm>
#include <cmath>

#include "core/constants.h"

namespace npdr::inference {
namespace {

// Coordinate d of every half of a chain: (n, 2 C), a half a column. An odd draw in the middle is
// left out.
Eigen::MatrixXd halves_of(const ChainDraws& draws, Index d) {
  const Index chains = draws.num_chains, length = draws.u.rows() / chains, half = length / 2;
  Eigen::MatrixXd halves(half, 2 * chains);
  for (Index c = 0; c < chains; ++c) {
    for (Index s = 0; s < half; ++s) {
      halves(s, 2 * c) = draws.u(s * chains + c, d);
      halves(s, 2 * c + 1) = draws.u((length - half + s) * chains + c, d);
    }
  }
  return halves;
}

struct Variances {
  double within = 0.0, total = 0.0;  // W and var^+
};

Variances variances_of(const Eigen::MatrixXd& halves) {
  const auto n = static_cast<double>(halves.rows()), m = static_cast<double>(halves.cols());
  const Eigen::RowVectorXd means = halves.colwise().mean();
  const Eigen::RowVectorXd spreads = (halves.rowwise() - means).colwise().squaredNorm() / (n - 1.0);
  const double between = (means.array() - means.mean()).square().sum() / (m - 1.0);
  return {spreads.mean(), (n - 1.0) / n * spreads.mean() + between};
}

// Mean over the columns of their autocovariance at `lag`, divided by n.
double autocovariance(const Eigen::MatrixXd& centered, Index lag) {
  const Index n = centered.rows();
  return (centered.topRows(n - lag).cwiseProduct(centered.bottomRows(n - lag)))
             .colwise()
             .sum()
             .mean() /
         static_cast<double>(n);
}

double effective_size(const Eigen::MatrixXd& halves) {
  const Variances v = variances_of(halves);
  const Eigen::MatrixXd centered = halves.rowwise() - halves.colwise().mean();
  const auto n = static_cast<double>(halves.rows());
  // rho_t = 1 - (W - mean of s_m^2 rho_{t,m}) / var^+, with s_m^2 rho_{t,m} scaled to n - 1.
  const auto correlation = [&](Index lag) {
    return 1.0 - (v.within - autocovariance(centered, lag) * n / (n - 1.0)) / v.total;
  };
  double sum = 0.0, pair_before = kInfinity;
  for (Index t = 0; t + 1 < halves.rows(); t += 2) {
    const double pair = (t == 0 ? 1.0 : correlation(t)) + correlation(t + 1);
    if (!(pair > 0.0)) break;
    pair_before = std::min(pair, pair_before);
    sum += pair_before;
  }
  const double draws = n * static_cast<double>(halves.cols());
  const double time = std::max(2.0 * sum - 1.0, 1.0 / std::log10(draws));
  return draws / time;
}

}  // namespace

ChainDiagnostics diagnose(const ChainDraws& draws) {
  const Index dimension = draws.u.cols();
  ChainDiagnostics result{Vector::Constant(dimension, kNaN), Vector::Constant(dimension, kNaN)};
  if (draws.u.rows() / std::max<Index>(draws.num_chains, 1) < 4) return result;
  for (Index d = 0; d < dimension; ++d) {
    const Eigen::MatrixXd halves = halves_of(draws, d);
    const Variances v = variances_of(halves);
    result.r_hat(d) = std::sqrt(v.total / v.within);
    result.ess(d) = effective_size(halves);
  }
  return result;
}

}  // namespace npdr::inference
