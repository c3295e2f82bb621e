#include "bench/known_posteriors.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "bench/likelihood_tasks.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/text.h"

namespace npdr::bench {
namespace {

using inference::Marginal;
using inference::Prior;

constexpr Index kLinearDimension = 10;

// A task with `draw(x_o, stream)` for one sample; each has a stream of its own.
template <class Draw>
KnownPosterior drawn_task(const std::string& name, const Prior& prior,
                          inference::SimulatorFunction simulator, Draw draw) {
  return {name, prior, std::move(simulator),
          [draw, dimension = prior.dimension()](const VectorF& x_o, Index n, std::uint64_t seed) {
            RowMatrix theta(n, dimension);
            parallel_for(n, [&](Index i) {
              Stream stream({seed, "exact_posterior", 0, static_cast<std::uint64_t>(i), 0});
              theta.row(i) = draw(x_o, stream).transpose();
            });
            return theta;
          }};
}

// Draws until one lies in the prior.
template <class Draw>
Vector inside(const Prior& prior, const Draw& draw) {
  Vector theta = draw();
  while (!prior.contains(theta)) theta = draw();
  return theta;
}

Vector normals(Index n, Stream& stream) {
  return Vector::NullaryExpr(n, [&] { return stream.normal(); });
}

// theta ~ U(-1, 1)^2; x = (r cos a + 1/4, r sin a) + (-|t1 + t2|, t2 - t1) / sqrt 2 with
// a ~ U(-pi / 2, pi / 2), r ~ N(0.1, 0.01^2): theta -> the second term is a fold and a rotation, so
// p(theta | x) has two crescents, mirrored at t1 = -t2.
Vector crescent(Stream& stream) {
  const double angle = std::numbers::pi * (stream.uniform() - 0.5);
  const double radius = 0.1 + 0.01 * stream.normal();
  Vector p(2);
  p << radius * std::cos(angle) + 0.25, radius * std::sin(angle);
  return p;
}

VectorF two_moons_x(const Vector& theta, Stream& stream) {
  Vector x = crescent(stream);
  x(0) -= std::abs(theta(0) + theta(1)) / std::numbers::sqrt2;
  x(1) += (theta(1) - theta(0)) / std::numbers::sqrt2;
  return x.cast<float>();
}

// With p of a crescent |t1 + t2| / sqrt 2 = p1 - x1, which isn't negative, and
// (t1 - t2) / sqrt 2 = p2 - x2; either sign of the first.
Vector two_moons_theta(const VectorF& x_o, Stream& stream) {
  Vector p = crescent(stream) - x_o.cast<double>();
  while (p(0) < 0.0) p = crescent(stream) - x_o.cast<double>();
  const double sum = stream.uniform() < 0.5 ? p(0) : -p(0);
  Vector theta(2);
  theta << sum + p(1), sum - p(1);
  return theta / std::numbers::sqrt2;
}

KnownPosterior two_moons() {
  const Prior prior = same_marginals(2, Marginal::Kind::uniform, -1.0, 1.0);
  return drawn_task("two_moons", prior, two_moons_x, [prior](const VectorF& x_o, Stream& stream) {
    return inside(prior, [&] { return two_moons_theta(x_o, stream); });
  });
}

// "Simple likelihood, complex posterior": x is four points ~ N(m, S) with m = (t1, t2),
// s1 = t3^2, s2 = t4^2 and correlation tanh t5.
Eigen::Matrix2d slcp_covariance(double t3, double t4, double t5) {
  const double s1 = t3 * t3, s2 = t4 * t4, rho = std::tanh(t5);
  Eigen::Matrix2d covariance;
  covariance << s1 * s1, rho * s1 * s2, rho * s1 * s2, s2 * s2;
  return covariance;
}

VectorF slcp_x(const Vector& theta, Stream& stream) {
  const Eigen::Matrix2d root = slcp_covariance(theta(2), theta(3), theta(4)).llt().matrixL();
  VectorF x(8);
  for (Index i = 0; i < 4; ++i) {
    x.segment<2>(2 * i) = (theta.head<2>() + root * normals(2, stream)).cast<float>();
  }
  return x;
}

// Over a flat m the likelihood of four points with mean c and scatter A = sum (x - c) (x - c)' is
//   |S|^(-3/2) exp(-tr(S^-1 A) / 2),  at most that of S = A / 3,
// and m given S is N(c, S / 4): S by rejection, and both again where m is outside of the prior.
Vector slcp_theta(const Prior& prior, const VectorF& x_o, Stream& stream) {
  const Eigen::Matrix<double, 2, 4> points =
      Eigen::Map<const Eigen::Matrix<float, 2, 4>>(x_o.data()).cast<double>();
  const Eigen::Vector2d center = points.rowwise().mean();
  const Eigen::Matrix2d scatter =
      (points.colwise() - center) * (points.colwise() - center).transpose();
  const auto log_likelihood = [&](const Eigen::Matrix2d& s) {
    return -1.5 * std::log(s.determinant()) - 0.5 * (s.inverse() * scatter).trace();
  };
  const double most = log_likelihood(scatter / 3.0);
  return inside(prior, [&] {
    Vector theta = prior.sample(stream);
    Eigen::Matrix2d s = slcp_covariance(theta(2), theta(3), theta(4));
    while (!(std::log(stream.uniform()) < log_likelihood(s) - most)) {
      theta = prior.sample(stream);
      s = slcp_covariance(theta(2), theta(3), theta(4));
    }
    theta.head<2>() = center + 0.5 * (Eigen::Matrix2d(s.llt().matrixL()) * normals(2, stream));
    return theta;
  });
}

KnownPosterior slcp() {
  const Prior prior = same_marginals(5, Marginal::Kind::uniform, -3.0, 3.0);
  return drawn_task("slcp", prior, slcp_x, [prior](const VectorF& x_o, Stream& stream) {
    return slcp_theta(prior, x_o, stream);
  });
}

// The same, with 92 features behind it that say nothing: Student t with two degrees of freedom.
KnownPosterior slcp_with_noise() {
  KnownPosterior task = slcp();
  task.name = "slcp_with_noise";
  task.simulator = [](const Vector& theta, Stream& stream) {
    VectorF x(100);
    x.head(8) = slcp_x(theta, stream);
    for (float& value : x.tail(92)) {
      value = static_cast<float>(stream.normal() / std::sqrt(-std::log(stream.uniform())));
    }
    return x;
  };
  return task;
}

VectorF linear_x(const Vector& theta, Stream& stream) {
  return (theta + std::sqrt(0.1) * normals(theta.size(), stream)).cast<float>();
}

// theta ~ N(0, 0.1 I), x ~ N(theta, 0.1 I): p(theta | x) = N(x / 2, 0.05 I).
KnownPosterior gaussian_linear() {
  return drawn_task(
      "gaussian_linear",
      same_marginals(kLinearDimension, Marginal::Kind::normal, 0.0, std::sqrt(0.1)), linear_x,
      [](const VectorF& x_o, Stream& stream) {
        return Vector(0.5 * x_o.cast<double>() + std::sqrt(0.05) * normals(x_o.size(), stream));
      });
}

// The same likelihood, theta ~ U(-1, 1)^10: p(theta | x) = N(x, 0.1 I) inside of the box, which
// each dimension is in or not by itself.
KnownPosterior gaussian_linear_uniform() {
  return drawn_task("gaussian_linear_uniform",
                    same_marginals(kLinearDimension, Marginal::Kind::uniform, -1.0, 1.0), linear_x,
                    [](const VectorF& x_o, Stream& stream) {
                      return Vector(x_o.cast<double>().unaryExpr([&](double x) {
                        double theta = x + std::sqrt(0.1) * stream.normal();
                        while (std::abs(theta) > 1.0) theta = x + std::sqrt(0.1) * stream.normal();
                        return theta;
                      }));
                    });
}

// theta ~ U(-10, 10)^2, x ~ N(theta, I) or N(theta, 0.01 I), as likely.
Vector two_scales(Stream& stream) {
  const double deviation = stream.uniform() < 0.5 ? 1.0 : 0.1;
  return deviation * normals(2, stream);
}

KnownPosterior gaussian_mixture() {
  const Prior prior = same_marginals(2, Marginal::Kind::uniform, -10.0, 10.0);
  const auto simulator = [](const Vector& theta, Stream& stream) {
    return VectorF((theta + two_scales(stream)).cast<float>());
  };
  return drawn_task(
      "gaussian_mixture", prior, simulator, [prior](const VectorF& x_o, Stream& stream) {
        return inside(prior, [&] { return Vector(x_o.cast<double>() + two_scales(stream)); });
      });
}

using Maker = KnownPosterior (*)();
constexpr Maker kTasks[] = {two_moons,
                            slcp,
                            gaussian_linear,
                            gaussian_linear_uniform,
                            gaussian_mixture,
                            bernoulli_glm_whitened,
                            bernoulli_glm_whitened_raw,
                            sir,
                            lotka_volterra,
                            slcp_with_noise};

}  // namespace

std::vector<std::string> known_posterior_names() {
  std::vector<std::string> names;
  for (const Maker make : kTasks) names.push_back(make().name);
  return names;
}

KnownPosterior known_posterior(const std::string& name) {
  for (const Maker make : kTasks) {
    if (KnownPosterior task = make(); task.name == name) return task;
  }
  throw InputError(unknown_name("task", name, known_posterior_names()));
}

VectorF observation(const KnownPosterior& task, Index number) {
  Stream stream({static_cast<std::uint64_t>(number), "observation", 0, 0, 0});
  const Vector theta = task.prior.sample(stream);
  return task.simulator(theta, stream);
}

Prior same_marginals(Index dimension, Marginal::Kind kind, double a, double b) {
  std::vector<Marginal> marginals;
  for (Index d = 0; d < dimension; ++d) {
    marginals.push_back({fmt::format("theta_{}", d + 1), "1", kind, a, b});
  }
  return Prior(std::move(marginals));
}

}  // namespace npdr::bench
