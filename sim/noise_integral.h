/// Integrals over the noise's unknown parameters, in the space where their prior is N(0, I).
#pragma once

#include <Eigen/Core>
#include <functional>

#include "core/types.h"

namespace npdr::sim {

/// log of what is integrated, over z; -infinity where that is 0, never NaN.
using LogIntegrand = std::function<double(const Vector&)>;

/// A Gaussian that touches the integrand at its mode.
struct Peak {
  Vector mode;
  Eigen::MatrixXd factor;  ///< lower, L L^T = (-f'')^-1
};

/// Climbs from `guess` by Newton's method, with derivatives by differences.
Peak find_peak(const LogIntegrand& f, const Vector& guess);

/// log of the integral of exp f, by Gauss-Hermite quadrature around the mode that a climb from
/// `guess` ends in, with the curvature there: 7 nodes a parameter for one or two of them, 5 for
/// three; for more Laplace's approximation, which is 1. Where one or two parameters have an end
/// within reach of the nodes, by midpoints of a grid.
double log_integral(const LogIntegrand& f, const Vector& guess);

}  // namespace npdr::sim
