#include "pipeline/predictions/left_out.h"

#include <algorithm>
#include <array>

#include "analysis/predictive_scores.h"
#include "core/parallel.h"
#include "inference/weighted_population.h"
#include "pipeline/predictions/prediction.h"

namespace npdr::pipeline {
namespace {

constexpr Index kEnsemble = 500;  // resampled draws that predict a rollout
constexpr double kLevel = 0.9;    // of the bands that noise is to make right
constexpr double kAsGood = 0.01;  // of a score
constexpr double kNearer = 0.02;  // to kLevel, of bands that are worth another factor
// The first is the one where all are about as good.
constexpr std::array kNoiseFactors = {1.0, 0.70711, 0.5, 0.35355, 0.25, 1.41421, 2.0};

// log p of all rollouts but `left_out` (-1: of all), of each row (n).
Vector log_likelihoods(const sim::NoiseLikelihood& noise, const sim::Trajectories& rows,
                       Index left_out) {
  Vector logs(rows.num_rows);
  parallel_for(rows.num_rows,
               [&](Index i) { logs(i) = noise.log_likelihood_without(left_out, rows.row(i)); });
  return logs;
}

// Draws of a posterior that hasn't seen a rollout, and whose errors of the others say what its
// noise is like.
struct LeftOut {
  Index rollout;
  Vector weights;
  Vector noise_weights;
  double noise_factor;
};

// Rollout h of resampled rows, with noise, as rows of a single rollout.
sim::Trajectories ensemble_of(const LeftOut& draws, const sim::NoiseLikelihood& noise,
                              const sim::Trajectories& rows, const StreamId& id) {
  const Index h = draws.rollout;
  const inference::Resampler resampler(draws.weights), noise_resampler(draws.noise_weights);
  sim::Trajectories ensemble;
  ensemble.resize(kEnsemble, 1, rows.num_steps, rows.num_states);
  const auto size = static_cast<std::size_t>(ensemble.row_size());
  parallel_for(kEnsemble, [&](Index i) {
    StreamId own = within(id, "left_out_noise");
    own.row = static_cast<std::uint64_t>(i);
    own.epoch = static_cast<std::uint64_t>(h);
    Stream stream(own);
    const auto row = rows.row(resampler.draw(stream.uniform()));
    const Index size_of_all = noise.model().num_rollouts() * ensemble.row_size();
    std::vector<float> series(row.begin(), row.begin() + size_of_all);
    const auto noisy = rows.row(noise_resampler.draw(stream.uniform()));
    const auto values = noise.model().with_unknown_scales_times(
        draws.noise_factor, noise.draw_values(noisy, stream, h));
    noise.model().add(series, values, stream);
    std::ranges::copy_n(
        series.begin() + static_cast<std::ptrdiff_t>(h) * std::ssize(ensemble.row(i)),
        static_cast<std::ptrdiff_t>(size), ensemble.row(i).begin());
    ensemble.status[static_cast<std::size_t>(i)] = sim::RolloutStatus::ok;
  });
  return ensemble;
}

// Of each factor (F) and left-out rollout (H), means over channels.
struct FactorScores {
  RowMatrix crps;
  RowMatrix coverage;  // of the bands of kLevel

  Index least() const {
    Index least = 0;
    crps.rowwise().mean().minCoeff(&least);
    return least;
  }

  // The score hardly tells factors whose bands hold far more or less than they should, and its
  // least is at too small a one where errors are large here and small there.
  Index chosen() const {
    const Vector score = crps.rowwise().mean();
    const Vector off = (coverage.rowwise().mean().array() - kLevel).abs();
    const double bound = (1.0 + kAsGood) * score(least());
    const Index first = score(0) <= bound ? 0 : least();
    Index nearest = first;
    for (Index f = 0; f < score.size(); ++f) {
      if (score(f) <= bound && off(f) < off(nearest)) nearest = f;
    }
    return off(nearest) < off(first) - kNearer ? nearest : first;
  }
};

}  // namespace

Vector weights_at_power(const Vector& weights, const Vector& log_likelihood, double power) {
  return inference::truncated(weights.array().log() + power * log_likelihood.array());
}

void add_power(PowerScores& scores, double power, const LeftOutScore& score) {
  const Index k = scores.power.size();
  const Index at = std::ranges::lower_bound(scores.power, power) - scores.power.begin();
  PowerScores more{Vector(k + 1), Vector(k + 1), RowMatrix(k + 1, score.crps.size())};
  for (Index i = 0; i < k; ++i) {
    const Index to = i < at ? i : i + 1;
    more.power(to) = scores.power(i);
    more.noise_factor(to) = scores.noise_factor(i);
    more.crps.row(to) = scores.crps.row(i);
  }
  more.power(at) = power;
  more.noise_factor(at) = score.noise_factor;
  more.crps.row(at) = score.crps.transpose();
  scores = std::move(more);
}

double best_power(const PowerScores& scores) {
  const Vector means = scores.crps.rowwise().mean();
  const double bound = scores.as_good_as_any();
  return scores.power(std::ranges::find_if(means, [&](double m) { return m <= bound; }) -
                      means.begin());
}

bool are_enough(const PowerScores& scores, double most) {
  constexpr double farther = 2.0, rise = 1.2;
  constexpr Index more_powers = 3, patience = 10;  // levels
  const Index k = scores.power.size();
  if (k == 0) return false;
  const double highest = scores.power(k - 1);
  const bool is_stuck = k > patience && highest < rise * scores.power(k - 1 - patience);
  const bool is_far =
      highest >= farther * scores.power(scores.least()) && k - 1 - scores.least() >= more_powers;
  return is_stuck || is_far || highest >= most;
}

LeftOutScore left_out_score(const sim::NoiseLikelihood& noise, const std::vector<float>& recorded,
                            const sim::Trajectories& rows, const Vector& weights, double power,
                            const StreamId& id) {
  const Vector all = log_likelihoods(noise, rows, -1);
  const auto has_unknown = [](const sim::ChannelNoise& channel) {
    return channel.scale.is_unknown();
  };
  const bool any_unknown = std::ranges::any_of(noise.model().channels(), has_unknown);
  const Index num_factors = any_unknown ? std::ssize(kNoiseFactors) : 1;
  const Index num_rollouts = noise.model().num_rollouts();
  FactorScores scores{RowMatrix(num_factors, num_rollouts), RowMatrix(num_factors, num_rollouts)};
  for (Index h = 0; h < num_rollouts; ++h) {
    const Vector others = log_likelihoods(noise, rows, h);
    const Vector without = weights_at_power(weights, others - all, power);
    LeftOut draws{h, without, weights_at_power(without, others, 1.0 - power), 1.0};
    const Eigen::Map<const RowMatrixF> observed(
        recorded.data() + h * rows.num_steps * rows.num_states, rows.num_steps, rows.num_states);
    for (Index f = 0; f < num_factors; ++f) {
      draws.noise_factor = kNoiseFactors[static_cast<std::size_t>(f)];
      const sim::Trajectories ensemble = ensemble_of(draws, noise, rows, id);
      const analysis::PredictiveScores of_rollout = analysis::predictive_scores(
          view_of(ensemble), {observed.cast<double>()}, noise.model().measure().row(h), {kLevel});
      scores.crps(f, h) = of_rollout.crps.mean();
      scores.coverage(f, h) = of_rollout.coverage.mean();
    }
  }
  return {kNoiseFactors[static_cast<std::size_t>(scores.chosen())],
          scores.crps.row(scores.least()).transpose()};
}

}  // namespace npdr::pipeline
