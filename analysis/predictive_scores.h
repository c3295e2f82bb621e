/// Scores of probabilistic predictions: how well n simulated rollouts say where the recorded ones
/// go, and how sure one can be of it.
///
/// For each rollout h, time t and channel c the samples' states x_1, ..., x_n are an ensemble that
/// predicts one observed state y:
///   crps      = mean_i |x_i - y| - 1 / (2 n (n - 1)) sum_ij |x_i - x_j|,
///               in units of the channel's amplitude in this rollout
///   within    = 1 where the ensemble's quantiles (1 - p) / 2 and (1 + p) / 2 have y between them,
///               or equal to one of them, otherwise 0; p is the level of the band
///   log score = log mean_i p(y | x_i), p being the density of the observation noise
/// each averaged over the H rollouts and T times, channel by channel.
///
/// The continuous ranked probability score (Gneiting and Raftery 2007, "Strictly proper scoring
/// rules, prediction, and estimation", eq. 21 with the sign of an error) is least, on average, for
/// the distribution that y comes from; that of a point is its absolute error. Its second term is
/// the unbiased one, which is fair to ensembles of any size (Ferro 2014, "Fair scores for ensemble
/// forecasts"): the expectation doesn't depend on n >= 2, and a single value may be below 0. The
/// log score [nats] is largest for the right distribution, and unforgiving of surprises. Both see
/// one channel at one time: they don't notice whether a rollout hangs together.
///
/// Where y is one more draw from the distribution of the samples, a band of level p holds it with
/// probability about p (n - 1) / (n + 1), exactly so for a uniform one: its ends are quantiles of n
/// samples. Rollouts without observation noise hold noisy observations less often.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "analysis/trajectory_view.h"
#include "core/types.h"

namespace npdr::analysis {

/// The fair score of one ensemble of ascending values, in their unit; O(n). One value: its absolute
/// error; NaN when there are none.
double crps_of_sorted(std::span<const double> sorted, double y);

/// Means over rollouts and times; NaN throughout when every sample failed.
struct PredictiveScores {
  Vector crps;            ///< (C) in units of the amplitude
  RowMatrix coverage;     ///< (L, C) share of the observed states within the band of each level
  Index num_samples = 0;  ///< n: those whose rollouts didn't fail
};

/// Scores of rollouts (n, H, T, C) whose samples with a value that isn't finite are left out.
/// `observed`: entry h is rollout h, (T, C), states 1 to T in the unit of `simulated`; `amplitude`:
/// (H, C), the largest recorded magnitudes; `levels`: (L) of central bands, in any order, whose
/// ends are quantile_of_sorted(). Each ensemble is sorted once: O(H T C (n log^2 n + L)). Parallel,
/// with the same bits for any number of threads. Throws ShapeError when shapes don't go together
/// and as TrajectoryView::check(); InputError for an observed state that isn't finite, an amplitude
/// that isn't finite and > 0, and a level outside (0, 1).
PredictiveScores predictive_scores(const TrajectoryView& simulated,
                                   const std::vector<RowMatrix>& observed,
                                   const RowMatrix& amplitude,
                                   const std::vector<double>& levels = {0.5, 0.9});

/// Coverage of an observation beside those that samples would have in its place.
struct ComparedCoverage {
  double observed = 0.0;  ///< share of the observed states within the bands
  Vector samples;         ///< (n) share of each sample's own; NaN: it has a value that isn't finite
  Index num_samples = 0;  ///< those that have none
};

/// Over all rollouts, times and channels, in central bands of n + 1 values each: the samples' and
/// the observed one. So an observation that is one more independent draw of what the samples come
/// from has each rank among them with the same probability, whatever n. The rest as for
/// predictive_scores().
ComparedCoverage compare_coverage(const TrajectoryView& simulated,
                                  const std::vector<RowMatrix>& observed, double level);

/// One state of a sample's rollout.
struct SampledState {
  Index sample;
  Index rollout;
  Index time;
  Index channel;
};

/// log p(y | x) [nats] of a state of which a sample says x, by the error y - x; -infinity at least.
using ErrorDensity = std::function<double(const SampledState&, double error)>;

/// (C) log scores for observation noise of `log_density`, which is called by several threads;
/// `simulated` hasn't got this noise. The rest, and what is thrown, as for predictive_scores().
Vector log_score(const TrajectoryView& simulated, const std::vector<RowMatrix>& observed,
                 const ErrorDensity& log_density);

}  // namespace npdr::analysis
