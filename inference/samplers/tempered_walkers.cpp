#include "inference/samplers/tempered_walkers.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "inference/samplers/importance_weights.h"
#include "inference/samplers/resampler.h"
#include "inference/weighted_moments.h"

namespace npdr::inference {
namespace {

constexpr double kWantedRate = 0.2;                 // of steps that are taken
constexpr double kSpread = 0.5;                     // of a step's length, in nats
constexpr double kShortest = 0.01, kLongest = 1.0;  // step lengths

// The weights of another power, the largest 1.
Vector weights_at(const TemperedWalkers& walkers, double power) {
  return exponentials((power - walkers.power) * walkers.log_likelihood);
}

// The factor L of the covariance L L^T; of a little more where walkers are all in one place.
Eigen::MatrixXd step_factor(const RowMatrix& u) {
  Eigen::MatrixXd covariance = weighted_covariance(u, Vector::Ones(u.rows()));
  covariance.diagonal().array() += 1e-12 + 1e-9 * covariance.diagonal().array();
  return Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL();
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
  walkers.power = power;
  walkers.num_sweeps = 0;
  return rows;
}

RowMatrix propose_steps(const TemperedWalkers& walkers, const StreamId& id) {
  const Index n = walkers.u.rows(), dimension = walkers.u.cols();
  const Eigen::MatrixXd factor = step_factor(walkers.u);
  const double scale = 2.38 / std::sqrt(static_cast<double>(dimension)) * walkers.step_length;
  RowMatrix proposed = walkers.u;
  for (Index i = 0; i < n; ++i) {
    Stream stream = stream_of(id, i);
    const double g = scale * std::exp(kSpread * stream.normal());
    if (stream.uniform() < 0.5) {
      const Index j = other_than(i, i, n, stream), k = other_than(i, j, n, stream);
      proposed.row(i) += g / std::sqrt(2.0) * (walkers.u.row(j) - walkers.u.row(k));
    } else {
      Vector normal(dimension);
      for (double& value : normal) value = stream.normal();
      proposed.row(i) += (g * (factor * normal)).transpose();
    }
  }
  return proposed;
}

void take_steps(TemperedWalkers& walkers, const RowMatrix& proposed, const Vector& log_likelihood,
                const StreamId& id) {
  Index taken = 0;
  for (Index i = 0; i < proposed.rows(); ++i) {
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
  const double rate = static_cast<double>(taken) / static_cast<double>(proposed.rows());
  walkers.step_length =
      std::clamp(walkers.step_length * std::exp(rate - kWantedRate), kShortest, kLongest);
  ++walkers.num_sweeps;
}

}  // namespace npdr::inference
