#include "bench/likelihood_tasks.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "inference/samplers/importance_sampler.h"
#include "inference/weighted_population.h"

namespace npdr::bench {
namespace {

using inference::Marginal;
using inference::Prior;
using LogLikelihood = std::function<double(const Vector& theta, const VectorF& x_o)>;

RowMatrix importance_samples(const Prior& prior, const LogLikelihood& log_likelihood,
                             const VectorF& x_o, Index n, std::uint64_t seed) {
  const inference::ImportanceConfig config{.min_ess = 5.0 * static_cast<double>(n),
                                           .max_simulations = std::max<Index>(1'000'000, 100 * n)};
  inference::ImportanceSampler sampler(config, prior.dimension(), {}, {seed, "exact", 0, 0, 0});
  while (!sampler.is_done()) {
    const RowMatrix theta = prior.to_theta(sampler.next(config.level_size));
    Vector values(theta.rows());
    parallel_for(theta.rows(),
                 [&](Index i) { values(i) = log_likelihood(theta.row(i).transpose(), x_o); });
    sampler.tell(values);
  }
  const inference::ImportanceSample sample = sampler.sample();
  if (const auto faults = faults_of(sample.certificate); !faults.empty()) {
    throw Error("the reference posterior " + verdict(sample.certificate));
  }
  Stream stream({seed, "exact", 1, 0, 0});
  const std::vector<Index> chosen =
      inference::Resampler(sample.weights).systematic(n, stream.uniform());
  return prior.to_theta(sample.u(chosen, Eigen::all));
}

KnownPosterior likelihood_task(const std::string& name, const Prior& prior,
                               inference::SimulatorFunction simulator,
                               LogLikelihood log_likelihood) {
  return {name, prior, std::move(simulator),
          [prior, log_likelihood = std::move(log_likelihood)](const VectorF& x_o, Index n,
                                                              std::uint64_t seed) {
            return importance_samples(prior, log_likelihood, x_o, n, seed);
          }};
}

Marginal log_normal(const std::string& name, double mean, double deviation) {
  return {name, "1", Marginal::Kind::log_normal, mean, deviation};
}

// Runge and Kutta's step of fourth order.
template <class State, class Rates>
State rk4_step(const State& y, double dt, const Rates& rates) {
  const State k1 = rates(y), k2 = rates(State(y + 0.5 * dt * k1));
  const State k3 = rates(State(y + 0.5 * dt * k2)), k4 = rates(State(y + dt * k3));
  return y + dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
}

constexpr Index kNumTimes = 10;

// (10, 2) of y(0), y(interval), ..., in steps of dt.
template <class Rates>
Eigen::Matrix<double, kNumTimes, 2> solve(Eigen::Array2d y, double interval, Index num_steps,
                                          const Rates& rates) {
  Eigen::Matrix<double, kNumTimes, 2> values;
  for (Index i = 0; i < kNumTimes; ++i) {
    values.row(i) = y.matrix().transpose();
    for (Index step = 0; step < num_steps; ++step) {
      y = rk4_step(y, interval / static_cast<double>(num_steps), rates);
    }
  }
  return values;
}

// Logarithms of the populations, (10) of X and (10) of Y.
Vector lotka_volterra_logs(const Vector& theta) {
  const auto values = solve({std::log(30.0), 0.0}, 2.1, 42, [&](const Eigen::Array2d& log_xy) {
    const Eigen::Array2d xy = log_xy.exp();
    return Eigen::Array2d(theta(0) - theta(1) * xy(1), theta(3) * xy(0) - theta(2));
  });
  return values.reshaped();
}

// Infected, as a share of all.
Vector sir_shares(const Vector& theta) {
  constexpr double kPopulation = 1e6;
  const auto values =
      solve({1.0 - 1.0 / kPopulation, 1.0 / kPopulation}, 17.0, 85, [&](const Eigen::Array2d& s_i) {
        const double infections = theta(0) * s_i(0) * s_i(1);
        return Eigen::Array2d(-infections, infections - theta(1) * s_i(1));
      });
  return values.col(1).cwiseMax(0.0).cwiseMin(1.0);
}

// log p of successes of n trials, but for the binomial coefficient.
double log_binomial(double successes, double n, double p) {
  const double failures = n - successes;
  return (successes > 0.0 ? successes * std::log(p) : 0.0) +
         (failures > 0.0 ? failures * std::log1p(-p) : 0.0);
}

struct Neuron {
  RowMatrix design;  ///< (100, 10): 1, v_t
  RowMatrix root;    ///< (10, 10): (beta, f) = root theta

  Vector logits(const Vector& theta) const { return design * (root * theta); }

  Vector spikes(const Vector& theta, Stream& stream) const {
    return logits(theta).unaryExpr([&](double logit) {
      return stream.uniform() < 1.0 / (1.0 + std::exp(-logit)) ? 1.0 : 0.0;
    });
  }

  // How many spikes there were, and the mean stimulus of one: all that the spikes say of theta.
  Vector summary(const Vector& spikes) const {
    Vector sums = design.transpose() * spikes;
    sums.tail(9) /= std::max(sums(0), 1.0);
    return sums;
  }

  // sum_t z_t logit_t - log(1 + exp(logit_t)), of which a summary says the first sum.
  double log_likelihood(const Vector& theta, Vector summary) const {
    summary.tail(9) *= summary(0);
    double value = summary.dot(root * theta);
    for (const double logit : logits(theta)) {
      value -= std::max(logit, 0.0) + std::log1p(std::exp(-std::abs(logit)));
    }
    return value;
  }
};

Neuron neuron() {
  Neuron n{RowMatrix::Ones(100, 10), RowMatrix::Zero(10, 10)};
  Stream stream({1, "stimulus", 0, 0, 0});
  for (double& value : n.design.rightCols(9).reshaped()) value = stream.normal();
  Eigen::MatrixXd differences = Eigen::MatrixXd::Zero(9, 9);
  for (Index i = 0; i < 9; ++i) {
    differences(i, i) = 1.0 + std::sqrt(static_cast<double>(i) / 9.0);
    if (i >= 1) differences(i, i - 1) = -2.0;
    if (i >= 2) differences(i, i - 2) = 1.0;
  }
  n.root(0, 0) = std::sqrt(2.0);
  n.root.bottomRightCorner(9, 9) =
      Eigen::MatrixXd((differences.transpose() * differences).inverse()).llt().matrixL();
  return n;
}

}  // namespace

KnownPosterior bernoulli_glm_whitened() {
  const Neuron cell = neuron();
  return likelihood_task(
      "bernoulli_glm_whitened", same_marginals(10, Marginal::Kind::normal, 0.0, 1.0),
      [cell](const Vector& theta, Stream& stream) {
        return VectorF(cell.summary(cell.spikes(theta, stream)).cast<float>());
      },
      [cell](const Vector& theta, const VectorF& x_o) {
        return cell.log_likelihood(theta, x_o.cast<double>());
      });
}

KnownPosterior bernoulli_glm_whitened_raw() {
  const Neuron cell = neuron();
  return likelihood_task(
      "bernoulli_glm_whitened_raw", same_marginals(10, Marginal::Kind::normal, 0.0, 1.0),
      [cell](const Vector& theta, Stream& stream) {
        return VectorF(cell.spikes(theta, stream).cast<float>());
      },
      [cell](const Vector& theta, const VectorF& x_o) {
        return cell.log_likelihood(theta, cell.summary(x_o.cast<double>()));
      });
}

KnownPosterior sir() {
  const Prior prior(
      {log_normal("beta", std::log(0.4), 0.5), log_normal("gamma", std::log(0.125), 0.2)});
  const auto simulator = [](const Vector& theta, Stream& stream) {
    return VectorF(sir_shares(theta).unaryExpr([&](double share) {
      float infected = 0.0f;
      for (int i = 0; i < 1000; ++i) infected += stream.uniform() < share ? 1.0f : 0.0f;
      return infected;
    }));
  };
  const auto log_likelihood = [](const Vector& theta, const VectorF& x_o) {
    const Vector shares = sir_shares(theta);
    double value = 0.0;
    for (Index i = 0; i < kNumTimes; ++i) value += log_binomial(x_o(i), 1000.0, shares(i));
    return value;
  };
  return likelihood_task("sir", prior, simulator, log_likelihood);
}

KnownPosterior lotka_volterra() {
  const Prior prior({log_normal("alpha", -0.125, 0.5), log_normal("beta", -3.0, 0.5),
                     log_normal("gamma", -0.125, 0.5), log_normal("delta", -3.0, 0.5)});
  const auto simulator = [](const Vector& theta, Stream& stream) {
    return VectorF(lotka_volterra_logs(theta).unaryExpr(
        [&](double log_x) { return static_cast<float>(std::exp(log_x + 0.1 * stream.normal())); }));
  };
  const auto log_likelihood = [](const Vector& theta, const VectorF& x_o) {
    const Vector errors = x_o.cast<double>().array().log().matrix() - lotka_volterra_logs(theta);
    return -0.5 * errors.squaredNorm() / (0.1 * 0.1);
  };
  return likelihood_task("lotka_volterra", prior, simulator, log_likelihood);
}

}  // namespace npdr::bench
