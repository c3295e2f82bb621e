/// Draws of a posterior p(u) ~ N(u; 0, I) L(u) whose modes may lie apart, by Markov chains.
///
/// A chain hardly ever leaves a mode, so a mode's share of the draws is its share of the chains'
/// starts. These come from sequential Monte Carlo (tempered_walkers.h): draws of the prior are
/// resampled at the largest power b of L at which four of them are effective for each chain, and
/// walk, ten sweeps for each dimension, from power to power until b = 1. Slice sampling
/// (slice_sampler.h) goes on from there.
///
/// Four populations climb independently of each other, from candidates of their own; chain c
/// belongs to population c mod 4. Split R-hat compares them, each as if it were one chain (nested
/// R-hat; Margossian et al. 2024): chains that stay in different modes are no fault as long as
/// each population has as many there. The effective size is that of the mean of all N draws,
///   (F - 1) / F  N sum_i (u_id - m_d)^2 / sum_f S_fd^2,  S_fd = sum_{i in f} (u_id - m_d),
/// at most N. Each of the F families f is all draws of chains that descend from one candidate, and
/// which depend on each other therefore (Chan and Lai 2013; Lee and Whiteley 2018).
#pragma once

#include "core/random.h"
#include "inference/posterior.h"
#include "inference/sampler_config.h"
#include "inference/samplers/log_density.h"

namespace npdr::inference {

struct TemperedDraws {
  RowMatrix u;  ///< (n, D)
  SamplerReport report;
};

/// n draws; draw i depends on `id` and i alone. `log_likelihood` is log L up to a constant; what
/// isn't a number counts as -infinity. config.num_chains is rounded up to a multiple of four.
/// Throws Error where no candidate's likelihood is a number.
TemperedDraws sample_tempered(const LogDensity& log_likelihood, Index dimension, Index n,
                              const SamplerConfig& config, const StreamId& id);

}  // namespace npdr::inference
