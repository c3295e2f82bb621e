#include "inference/samplers/tempered_walkers.h"

#include <algorithm>
#include <cmath>

#include "core/decompositions.h"
#include "core/error.h"
#include "core/parallel.h"
#include "inference/nearest_rows.h"
#include "inference/samplers/step_length.h"
#include "inference/weighted_population.h"

namespace npdr::inference {
namespace {

constexpr double kWantedRate = 0.2;                 // of steps that are taken
constexpr double kShortest = 0.01, kLongest = 1.0;  // step lengths
constexpr Index kNeighbors = 30;

// The weights of another power, the largest 1.
Vector weights_at(const TemperedWalkers& walkers, double power) {
  return exponentials((power - walkers.power) * walkers.log_likelihood);
}

// The factor L of the covariance L L^T; of a little more where walkers are all in one place.
Eigen::MatrixXd step_factor(const RowMatrix& u) {
  return Cholesky(regularized_covariance(u, Vector::Ones(u.rows()))).lower();
}

Stream stream_of(StreamId id, Index walker) {
  id.row = static_cast<std::uint64_t>(walker);
  return Stream(id);
}

// A number below n that is neither i nor j.
Index other_than(Index i, Index j, Index n, Stream& stream) {
  Index number = i;
  while (number == i || number == j) number = stream.below(static_cast<std::uint32_t>(n));
  return number;
}

// u_i + g / sqrt(2) (u_j - u_k).
Eigen::RowVectorXd by_difference(const RowMatrix& u, Index i, Index j, Index k, double g) {
  return u.row(i) + g / std::sqrt(2.0) * (u.row(j) - u.row(k));
}

double draw_length(double scale, Stream& stream) {
  return scale * std::exp(kSpreadOfSteps * stream.normal());
}

RowMatrix propose_wide(const RowMatrix& u, double scale, const StreamId& id) {
  const Index n = u.rows();
  const Eigen::MatrixXd factor = step_factor(u);
  RowMatrix proposed = u;
  for (Index i = 0; i < n; ++i) {
    Stream stream = stream_of(id, i);
    const double g = draw_length(scale, stream);
    if (stream.uniform() < 0.5) {
      const Index j = other_than(i, i, n, stream), k = other_than(i, j, n, stream);
      proposed.row(i) = by_difference(u, i, j, k, g);
    } else {
      Vector normal(u.cols());
      for (double& value : normal) value = stream.normal();
      proposed.row(i) += (g * (factor * normal)).transpose();
    }
  }
  return proposed;
}

RowMatrix propose_near(const TemperedWalkers& walkers, double scale, const StreamId& id) {
  const Index n = walkers.u.rows(), count = walkers.neighbors.cols();
  if (walkers.neighbors.rows() != n || count < 2) {
    throw ShapeError("walkers: near steps without neighbors");
  }
  RowMatrix proposed = walkers.u;
  for (Index i = 0; i < n; ++i) {
    Stream stream = stream_of(id, i);
    const double g = draw_length(scale, stream);
    const auto j = static_cast<Index>(stream.below(static_cast<std::uint32_t>(count)));
    const Index k = other_than(j, j, count, stream);
    proposed.row(i) =
        by_difference(walkers.u, i, walkers.neighbors(i, j), walkers.neighbors(i, k), g);
  }
  return proposed;
}

}  // namespace

double next_power(const TemperedWalkers& walkers, double most, double num_effective) {
  return largest_power(walkers.power, most, [&](double power) {
    return effective_size(weights_at(walkers, power)) >= num_effective;
  });
}

std::vector<Index> raise_power(TemperedWalkers& walkers, double power, Index count,
                               const StreamId& id) {
  const Vector weights = weights_at(walkers, power);
  walkers.log_evidence +=
      (power - walkers.power) * walkers.log_likelihood.maxCoeff() + std::log(weights.mean());
  std::vector<Index> rows = Resampler(weights).systematic(count, Stream(id).uniform());
  walkers.u = RowMatrix(walkers.u(rows, Eigen::all));
  walkers.log_likelihood = Vector(walkers.log_likelihood(rows));
  walkers.neighbors = {};
  walkers.power = power;
  walkers.num_sweeps = 0;
  return rows;
}

void choose_neighbors(TemperedWalkers& walkers) {
  const RowMatrix& u = walkers.u;
  const Eigen::RowVectorXd deviations =
      (u.rowwise() - u.colwise().mean()).colwise().norm().array().max(1e-12);
  const RowMatrix standardized = u.array().rowwise() / deviations.array();
  walkers.neighbors.resize(u.rows(), std::min(kNeighbors, u.rows() - 1));
  parallel_for(u.rows(), [&](Index i) {
    std::ranges::copy(nearest_rows(standardized, i, kNeighbors), walkers.neighbors.row(i).begin());
  });
}

RowMatrix propose_steps(const TemperedWalkers& walkers, StepKind kind, const StreamId& id) {
  const double scale = kBestStep / std::sqrt(static_cast<double>(walkers.u.cols())) *
                       walkers.step_lengths[static_cast<std::size_t>(kind)];
  return kind == StepKind::wide ? propose_wide(walkers.u, scale, id)
                                : propose_near(walkers, scale, id);
}

void take_steps(TemperedWalkers& walkers, StepKind kind, const RowMatrix& proposed,
                const Vector& log_likelihood, const StreamId& id) {
  Index taken = 0, count = 0;
  for (Index i = 0; i < proposed.rows(); ++i) {
    if (proposed.row(i) == walkers.u.row(i)) continue;  // both neighbors are in one place
    ++count;
    if (!std::isfinite(log_likelihood(i))) continue;
    const double log_prior_ratio =
        0.5 * (walkers.u.row(i).squaredNorm() - proposed.row(i).squaredNorm());
    const double log_ratio =
        walkers.power * (log_likelihood(i) - walkers.log_likelihood(i)) + log_prior_ratio;
    if (!(std::log(stream_of(id, i).uniform()) < log_ratio)) continue;
    walkers.u.row(i) = proposed.row(i);
    walkers.log_likelihood(i) = log_likelihood(i);
    ++taken;
  }
  const double rate = count > 0 ? static_cast<double>(taken) / static_cast<double>(count) : 0.0;
  double& length = walkers.step_lengths[static_cast<std::size_t>(kind)];
  length = std::clamp(length * std::exp(rate - kWantedRate), kShortest, kLongest);
  ++walkers.num_sweeps;
}

}  // namespace npdr::inference
