#include "inference/least_squares/least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <utility>

#include "inference/least_squares/descent.h"
#include "inference/least_squares/laplace_mixture.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

RowMatrix stacked(const RowMatrix& a, const RowMatrix& b) {
  RowMatrix both(a.rows() + b.rows(), a.cols());
  both << a, b;
  return both;
}

}  // namespace

LeastSquaresFit least_squares(const LeastSquaresProblem& problem, const RowMatrix& candidates,
                              const RowMatrix& starts, const LeastSquaresConfig& config,
                              Index max_rounds, const StreamId& id) {
  constexpr double better = 1.0, twice_as_wide = 4.0;
  Simulations simulations(problem, config.max_simulations);
  LeastSquaresFit fit;
  const auto minima_from = [&](const RowMatrix& from, const RowMatrix& known, bool& converged) {
    // Half of what is left at most is for candidates.
    const Index tried = std::min(from.rows(), std::max<Index>(1, simulations.num_left() / 2));
    const Index affordable =
        (simulations.num_left() - tried) / rows_of_start(simulations, from.cols());
    const Index count = std::clamp<Index>(affordable, 1, config.num_starts);
    const RowMatrix best = best_rows(simulations, from.topRows(tried), count);
    std::vector<Search> searches = descend(simulations, stacked(best, known), config.max_steps);
    converged = !searches.empty() && searches.front().is_done;
    if (max_rounds > 0) return laplace_mixture(simulations, std::move(searches));
    std::vector<Minimum> minima;
    for (const Search& each : searches) {
      minima.push_back({.u = each.u(), .cost = each.at.cost, .scales = each.at.scales});
    }
    return minima;
  };
  fit.minima = minima_from(candidates, starts, fit.converged);
  const Index of_round = candidates.rows() + rows_of_start(simulations, candidates.cols());
  for (Index round = 1;
       round < max_rounds && !fit.minima.empty() && simulations.num_left() >= of_round; ++round) {
    const double before = fit.minima.front().cost;
    LeastSquaresFit wider = fit;
    for (Minimum& minimum : wider.minima) minimum.covariance *= twice_as_wide;
    StreamId draws = within(id, "least_squares_round");
    draws.epoch = static_cast<std::uint64_t>(round);
    bool converged = false;
    std::vector<Minimum> next =
        minima_from(wider.sample(candidates.rows(), draws), minima_of(fit), converged);
    if (next.empty() || next.front().cost > before) {
      break;  // as of a simulator that draws at random
    }
    fit.minima = std::move(next);
    fit.converged = converged;
    if (fit.minima.front().cost > before - better) break;
  }
  fit.num_rows = simulations.num_rows();
  fit.num_failed = simulations.num_failed();
  return fit;
}

RowMatrix minima_of(const LeastSquaresFit& fit) {
  if (fit.minima.empty()) return {};
  RowMatrix u(std::ssize(fit.minima), fit.minima.front().u.size());
  for (Index i = 0; i < u.rows(); ++i) {
    u.row(i) = fit.minima[static_cast<std::size_t>(i)].u.transpose();
  }
  return u;
}

RowMatrix LeastSquaresFit::sample(Index n, const StreamId& id) const {
  Vector weights(std::ssize(minima));
  std::vector<Eigen::MatrixXd> roots;
  for (std::size_t m = 0; m < minima.size(); ++m) {
    weights(static_cast<Index>(m)) = minima[m].weight;
    roots.emplace_back(Eigen::LLT<Eigen::MatrixXd>(minima[m].covariance).matrixL());
  }
  const Resampler resampler(weights);
  RowMatrix u(n, minima.front().u.size());
  for (Index i = 0; i < n; ++i) {
    Stream stream(row_after(id, i));
    const auto m = static_cast<std::size_t>(resampler.draw(stream.uniform()));
    Vector normal(u.cols());
    for (double& each : normal) each = stream.normal();
    u.row(i) = (minima[m].u + roots[m] * normal).transpose();
  }
  return u;
}

}  // namespace npdr::inference
