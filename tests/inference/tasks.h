/// Inference tasks with known posteriors.
#pragma once

#include <Eigen/LU>
#include <vector>

#include "inference/in_memory.h"

namespace npdr::inference {

/// theta ~ N(0, I) in D dimensions, x = theta + N(0, 0.3^2 I) mixed by a fixed matrix A:
/// p(theta | x_o) = N(m, C), C = (I + A'A / s^2)^-1, m = C A' x_o / s^2.
struct LinearGaussian {
  Index dimension;
  Eigen::MatrixXd a;
  double noise = 0.3;

  explicit LinearGaussian(Index d) : dimension(d), a(Eigen::MatrixXd::Identity(d, d)) {
    for (Index i = 0; i + 1 < d; ++i) a(i, i + 1) = 0.5;
  }
  Prior prior() const {
    std::vector<Marginal> marginals;
    for (Index d = 0; d < dimension; ++d) {
      marginals.push_back({"theta_" + std::to_string(d), "1", Marginal::Kind::normal, 0.0, 1.0});
    }
    return Prior(marginals);
  }
  SimulatorFunction simulator() const {
    return [this](const Vector& theta, Stream& stream) {
      Vector x = a * theta;
      for (double& v : x) v += noise * stream.normal();
      return VectorF(x.cast<float>());
    };
  }
  Eigen::MatrixXd covariance() const {
    return (Eigen::MatrixXd::Identity(dimension, dimension) + a.transpose() * a / (noise * noise))
        .inverse();
  }
  Vector mean(const VectorF& x_o) const {
    return covariance() * a.transpose() * x_o.cast<double>() / (noise * noise);
  }
};

}  // namespace npdr::inference
