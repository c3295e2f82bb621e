#include "inference/least_squares/laplace_mixture.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "inference/least_squares/long_run_covariance.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr double kLeastWeight = 1e-4;  // of a minimum in the mixture

// A minimum, and the power to which its cost counts.
struct Curved {
  Minimum minimum;
  double power = 1.0;
};

// R: diagonal, (D).
Vector curvature_of_rounding(const Simulations& simulations, const Search& search,
                             const Vector& curvatures) {
  const Vector& rounding = simulations.problem().rounding;
  if (rounding.size() == 0) return Vector::Zero(search.moves.size());
  const auto steps = static_cast<double>(search.at.errors.rows());
  const double sum =
      steps *
      (curvatures.array() * rounding.array().square() / search.at.scales.array().square()).sum();
  return 0.5 * sum * search.moves.array().square().inverse();
}

// Shares of information that are kept, as a matrix F of P = F P F^T.
RowMatrix information_filter(const RowMatrix& a, const Vector& of_rounding) {
  constexpr double least = 10.0;
  const Index dimension = a.rows();
  if (!(of_rounding.minCoeff() > 0.0)) return RowMatrix::Identity(dimension, dimension);
  const Vector root = of_rounding.cwiseSqrt();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(root.cwiseInverse().asDiagonal() * a *
                                                             root.cwiseInverse().asDiagonal());
  const Vector shares = (1.0 - least / parts.eigenvalues().array().max(1e-300)).max(0.0).sqrt();
  return root.asDiagonal() * parts.eigenvectors() * shares.asDiagonal() *
         parts.eigenvectors().transpose() * root.cwiseInverse().asDiagonal();
}

// The covariance (I + A B^-1 A)^-1 of a minimum: with A + I = L L^T, A = L a L^T, B = L b L^T it is
// (I + L a b^-1 a L^T)^-1.
Curved curved(Simulations& simulations, Search& search) {
  const LeastSquaresProblem& problem = simulations.problem();
  const StudentErrors& noise = problem.noise;
  const Point& at = search.at;
  const Vector curvatures = noise.curvatures(at.errors, at.scales);
  WeightedErrors errors = weighted(noise, at, simulations.central_slopes(search));
  // Errors far out say little, also where simulations are sensitive.
  const Vector means = noise.weights(at.errors, at.scales).colwise().mean().transpose();
  errors.weights *= curvatures.cwiseQuotient(means).asDiagonal();
  const NormalEquations normal(errors, at.unknowns, problem.block_begins, problem.num_rollouts);
  const RowMatrix& a = normal.curvature();
  const Eigen::LLT<Eigen::MatrixXd> root(with_prior(a));
  const RowMatrix white =
      root.matrixL().solve(normal.scores_of_steps(errors).transpose()).transpose();
  const Index rollouts = problem.num_rollouts;
  RowMatrix b = long_run_covariance(white, rollouts, num_lags(white, rollouts));
  const RowMatrix a_white = root.matrixL().solve(root.matrixL().solve(a).transpose());
  Curved found;
  found.power = std::min(1.0, a_white.trace() / std::max(b.trace(), 1e-12));
  b.diagonal().array() += 1e-9 * std::max(1.0, b.diagonal().maxCoeff());
  const RowMatrix half =
      information_filter(a, curvature_of_rounding(simulations, search, curvatures)) *
      Eigen::MatrixXd(root.matrixL()) * a_white;
  RowMatrix precision = half * b.ldlt().solve(half.transpose());
  precision.diagonal().array() += 1.0;
  constexpr double most = 1e14;  // of a precision: its inverse can still be factored
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> parts(precision);
  const Vector variances = parts.eigenvalues().cwiseMax(1.0).cwiseMin(most).cwiseInverse();
  found.minimum = {.u = search.u(),
                   .cost = at.cost,
                   .scales = at.scales,
                   .covariance = parts.eigenvectors() * variances.asDiagonal() *
                                 parts.eigenvectors().transpose(),
                   .own = search.own()};
  return found;
}

// Shares of a mixture, of which the best and those that weigh something stay.
void weigh(std::vector<Curved>& all) {
  const double power = all.front().power, least = all.front().minimum.cost;
  Vector logs(std::ssize(all));
  for (std::size_t m = 0; m < all.size(); ++m) {
    const Minimum& minimum = all[m].minimum;
    const double prior = 0.5 * minimum.u.squaredNorm();
    const Eigen::LLT<Eigen::MatrixXd> root(minimum.covariance);
    const double log_volume = Eigen::MatrixXd(root.matrixL()).diagonal().array().log().sum();
    logs(static_cast<Index>(m)) = -power * (minimum.cost - least - prior) - prior + log_volume;
  }
  const Vector weights = exponentials(logs) / exponentials(logs).sum();
  for (std::size_t m = 0; m < all.size(); ++m) {
    all[m].minimum.weight = weights(static_cast<Index>(m));
  }
  const auto is_light = [](const Curved& each) { return each.minimum.weight < kLeastWeight; };
  all.erase(std::remove_if(all.begin() + 1, all.end(), is_light), all.end());
}

}  // namespace

std::vector<Minimum> laplace_mixture(Simulations& simulations, std::vector<Search> searches) {
  std::vector<Curved> all;
  for (Search& search : searches) all.push_back(curved(simulations, search));
  if (!all.empty()) weigh(all);
  std::vector<Minimum> minima;
  for (Curved& each : all) minima.push_back(std::move(each.minimum));
  return minima;
}

}  // namespace npdr::inference
