/// How well a posterior predicts rollouts that it hasn't seen, without inferring it again.
#pragma once

#include "core/random.h"
#include "sim/noise_likelihood.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// CRPS with noise, mean over channels, of each rollout h predicted by the posterior at the
/// likelihood's power a given the others: (H). `rows`: rollouts (n, H, K, C) of weighted draws of
/// the posterior given all; those of the posterior without h have the weights
///   w_i p(y_h | y_others, theta_i)^-a,
/// and noise is as their errors of the other rollouts say at power 1 (weights_at_power()).
/// `recorded`: (H, K, C).
Vector left_out_crps(const sim::NoiseLikelihood& noise, const std::vector<float>& recorded,
                     const sim::Trajectories& rows, const Vector& weights, double power,
                     const StreamId& id);

}  // namespace npdr::pipeline
