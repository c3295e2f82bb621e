/// Tasks of the benchmark of Lueckmann et al. (2021) whose likelihood is known, but no way to draw
/// from the posterior: samples are those of importance sampling (inference/samplers/
/// importance_sampler.h) of an effective size of five times their number, without replacement but
/// where a weight is large. Names are those of that benchmark, but for the first two.
#pragma once

#include "bench/known_posteriors.h"

namespace npdr::bench {

/// Spikes of a neuron: z_t ~ Bernoulli(sigmoid(beta + f . v_t)), t = 1 ... 100, with white noise
/// v_t (9). x (10): their number, and the mean stimulus of a spike. theta (10) ~ N(0, I) are
/// whitened: beta = sqrt(2) theta_1, f = L theta_2...10, L L' = (F'F)^-1 with F of second
/// differences. The stimulus is a draw of our own.
KnownPosterior bernoulli_glm_whitened();
/// The same, but x (100) are the spikes z_t.
KnownPosterior bernoulli_glm_whitened_raw();

/// An epidemic: dS/dt = -beta S I / N, dI/dt = beta S I / N - gamma I with N = 1e6, I(0) = 1.
/// x (10) ~ Binomial(1000, I / N) at t = 0, 17, ..., 153. log beta ~ N(log 0.4, 0.5),
/// log gamma ~ N(log 0.125, 0.2).
KnownPosterior sir();

/// Predators Y and prey X: dX/dt = alpha X - beta X Y, dY/dt = -gamma Y + delta X Y, (30, 1) at
/// t = 0. log x (20) ~ N(log X or log Y, 0.1^2) at t = 0, 2.1, ..., 18.9. log alpha, log gamma ~
/// N(-0.125, 0.5), log beta, log delta ~ N(-3, 0.5).
KnownPosterior lotka_volterra();

}  // namespace npdr::bench
