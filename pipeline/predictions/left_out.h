/// How well a posterior predicts rollouts that it hasn't seen, without inferring it again.
#pragma once

#include <vector>

#include "core/random.h"
#include "pipeline/artefacts/refinement_file.h"
#include "sim/noise_likelihood.h"
#include "sim/trajectories.h"

namespace npdr::pipeline {

/// Weights w_i L_i^power (n), over a constant, of draws with the weights w (n): those of the
/// posterior whose likelihood has one more factor L^power, L by its logs [nats] (n). Cut off at
/// their mean times sqrt(n) (Ionides 2008, "Truncated importance sampling"); 0 where log L isn't
/// finite.
Vector weights_at_power(const Vector& weights, const Vector& log_likelihood, double power);

struct LeftOutScore {
  double noise_factor = 1.0;  ///< of the noise's unknown scales
  Vector crps;                ///< (H) with the noise that makes it least, mean over channels
};

/// Adds the score of a power, which may be below earlier ones.
void add_power(PowerScores& scores, double power, const LeftOutScore& score);

/// The smallest power that is about as good as any: larger ones cost more, and say more of
/// parameters than predictions bear out. About as good: whose score, mean over rollouts, is worse
/// than the best by at most the standard error of the latter (Breiman et al. 1984, "Classification
/// and regression trees", 3.4.3), or a hundredth.
double best_power(const PowerScores& scores);

/// Whether there is nothing more to try: three larger powers than the one whose score is least have
/// been, up to twice as large or more, or `most`, or ten levels have raised it by less than a
/// fifth. Levels may raise the power tenfold, and the first ones know little of the posterior.
bool are_enough(const PowerScores& scores, double most);

/// How well the posterior at the likelihood's power a given the other rollouts predicts each
/// rollout h. `rows`: rollouts (n, H, K, C) of weighted draws of the posterior given all, or
/// (n, H (1 + C), K, C) where the likelihood infers first states. Those of the posterior without h
/// have the weights
///   w_i p(y_h | y_others, theta_i)^-a,
/// and noise is as their errors of the other rollouts say at power 1 (weights_at_power()), its
/// unknown scales times a power of sqrt(2), from 1/4 to 2: of those whose score is within a
/// hundredth of the least, 1 or the least's, unless another's bands of 90 % hold a share that is
/// nearer to that by more than two points.
/// `recorded`: (H, K, C).
LeftOutScore left_out_score(const sim::NoiseLikelihood& noise, const std::vector<float>& recorded,
                            const sim::Trajectories& rows, const Vector& weights, double power,
                            const StreamId& id);

}  // namespace npdr::pipeline
