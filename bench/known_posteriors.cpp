#include "bench/known_posteriors.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/text.h"

namespace npdr::bench {
namespace {

using inference::Marginal;
using inference::Prior;

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

// At x = 0: |t1 + t2| / sqrt 2 = p1, (t1 - t2) / sqrt 2 = p2 of a crescent, either sign.
Vector two_moons_theta(Stream& stream) {
  const Vector p = crescent(stream);
  const double sum = stream.uniform() < 0.5 ? p(0) : -p(0);
  Vector theta(2);
  theta << sum + p(1), sum - p(1);
  return theta / std::numbers::sqrt2;
}

KnownPosterior two_moons() {
  Prior prior({{"theta_1", "1", Marginal::Kind::uniform, -1.0, 1.0},
               {"theta_2", "1", Marginal::Kind::uniform, -1.0, 1.0}});
  return {"two_moons", std::move(prior), two_moons_x, VectorF::Zero(2), two_moons_theta};
}

// theta ~ N(0, 0.1 I), x ~ N(theta, 0.1 I): p(theta | x) = N(x / 2, 0.05 I).
KnownPosterior gaussian_linear() {
  constexpr Index dimension = 10;
  const double deviation = std::sqrt(0.1);
  std::vector<Marginal> marginals;
  VectorF x_o(dimension);
  Stream stream({1, "gaussian_linear_observation", 0, 0, 0});
  for (Index d = 0; d < dimension; ++d) {
    marginals.push_back(
        {fmt::format("theta_{}", d + 1), "1", Marginal::Kind::normal, 0.0, deviation});
    x_o(d) = static_cast<float>(std::sqrt(0.2) * stream.normal());  // as the task itself draws x
  }
  const auto simulator = [deviation](const Vector& theta, Stream& noise) {
    Vector x = theta;
    for (double& value : x) value += deviation * noise.normal();
    return VectorF(x.cast<float>());
  };
  const auto exact = [x_o](Stream& noise) {
    Vector theta = 0.5 * x_o.cast<double>();
    for (double& value : theta) value += std::sqrt(0.05) * noise.normal();
    return theta;
  };
  return {"gaussian_linear", Prior(marginals), simulator, x_o, exact};
}

}  // namespace

std::vector<std::string> known_posterior_names() { return {"two_moons", "gaussian_linear"}; }

KnownPosterior known_posterior(const std::string& name) {
  if (name == "two_moons") return two_moons();
  if (name == "gaussian_linear") return gaussian_linear();
  throw InputError(unknown_name("task", name, known_posterior_names()));
}

RowMatrix exact_samples(const KnownPosterior& task, Index n, std::uint64_t seed) {
  RowMatrix theta(n, task.prior.dimension());
  for (Index i = 0; i < n; ++i) {
    Stream stream({seed, "exact_posterior", 0, static_cast<std::uint64_t>(i), 0});
    theta.row(i) = task.exact(stream).transpose();
  }
  return theta;
}

}  // namespace npdr::bench
