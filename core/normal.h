/// The standard normal distribution: density, distribution function and quantile; and Student's t.
#pragma once

namespace npdr {

/// log phi(u) = -u^2/2 - log(2 pi)/2, in nats.
double log_normal_density(double u);

/// Phi(u) = P(U <= u). Exact to a few ulp over the whole range, tails included.
double normal_cdf(double u);

/// The u with Phi(u) = p, by Wichura's algorithm AS 241 (PPND16), relative error about 1e-16.
/// p in (0, 1); p <= 0 gives -infinity and p >= 1 gives +infinity.
double normal_quantile(double p);

/// log of the density of Student's t with nu > 0 degrees of freedom, in nats.
double log_student_t_density(double t, double nu);

}  // namespace npdr
