#include "pipeline/predictions/scores.h"

#include <algorithm>
#include <optional>

#include "analysis/predictive_scores.h"
#include "core/constants.h"
#include "core/parallel.h"
#include "inference/weighted_population.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/refinement_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/predictions/left_out.h"
#include "sim/noise_likelihood.h"

namespace npdr::pipeline {
namespace {

// Every store_every-th state of the first rollouts.
sim::Trajectories stored(const sim::Trajectories& all, Index num_rollouts, Index store_every) {
  sim::Trajectories some;
  some.resize(all.num_rows, num_rollouts, all.num_steps / store_every, all.num_states);
  some.status = all.status;
  parallel_for(all.num_rows, [&](Index i) {
    float* to = some.row(i).data();
    for (Index h = 0; h < num_rollouts; ++h) {
      const auto states = all.rollout(i, h);
      for (Index k = 1; k <= some.num_steps; ++k, to += all.num_states) {
        std::ranges::copy(states.row(k * store_every - 1), to);
      }
    }
  });
  return some;
}

// The same of series (H, K, C) that were observed, by rollout.
std::vector<RowMatrix> by_rollout(const std::vector<float>& series, Index rollouts, Index states) {
  const Index steps = std::ssize(series) / (rollouts * states);
  std::vector<RowMatrix> observed;
  for (Index h = 0; h < rollouts; ++h) {
    const Eigen::Map<const RowMatrixF> all(series.data() + h * steps * states, steps, states);
    observed.push_back(all.cast<double>());
  }
  return observed;
}

bool is_ok(const sim::Trajectories& rows, Index i) {
  return rows.status[static_cast<std::size_t>(i)] == sim::RolloutStatus::ok;
}

// Picks samples of a posterior at that power in proportion to the rest of their likelihood; none at
// power 1, and where all have failed.
std::optional<inference::Resampler> other_samples(const sim::NoiseLikelihood& likelihood,
                                                  const sim::Trajectories& rows, double power) {
  if (power == 1.0) return std::nullopt;
  Vector logs(rows.num_rows);
  parallel_for(rows.num_rows, [&](Index i) { logs(i) = likelihood.log_likelihood(rows.row(i)); });
  if (!logs.array().isFinite().any()) return std::nullopt;
  return inference::Resampler(weights_at_power(Vector::Ones(logs.size()), logs, 1.0 - power));
}

// By the densities of each sample's own noise.
Vector log_score(const sim::NoiseModel& model, const sim::Trajectories& rows,
                 const std::vector<RowMatrix>& observed, const NoiseOfSamples& noise) {
  for (Index c = 0; c < rows.num_states; ++c) {
    if (!model.has_density(c)) return {};
  }
  return analysis::log_score(
      view_of(rows), observed, [&](const analysis::SampledState& at, double error) {
        const auto i = static_cast<std::size_t>(at.sample),
                   c = static_cast<std::size_t>(at.channel);
        return model.log_marginal(at.rollout, at.time, at.channel, error, noise[i][c]);
      });
}

// How the observed coverage compares with those that the samples would have.
void compare(const sim::Trajectories& rows, const std::vector<RowMatrix>& observed,
             PredictionScores& scores) {
  const auto found = analysis::compare_coverage(view_of(rows), observed, kJudgedBand);
  scores.num_compared = found.num_samples;
  if (found.num_samples == 0) return;
  constexpr double rounding = 1e-9;
  const Index seldom = (found.samples.array() <= found.observed + rounding).count();
  scores.share_as_seldom_within =
      static_cast<double>(seldom) / static_cast<double>(found.num_samples);
}

// As predictions of what is observed.
PredictionScores score_part(const Observation& observation, const sim::Trajectories& all_states,
                            const NoiseOfSamples& noise, const StreamId& id) {
  const Target& target = observation.target();
  const Index store_every = observation.study().simulator.store_every;
  const sim::NoiseModel& model = observation.noise();
  sim::Trajectories rows = stored(all_states, target.num_rollouts(), store_every);
  const auto scores_of = [&](const std::vector<RowMatrix>& observed) {
    return analysis::predictive_scores(view_of(rows), observed, model.measure(), kBandLevels);
  };
  PredictionScores scores;
  const auto states = by_rollout(inference::observed_series(target, store_every),
                                 target.num_rollouts(), target.num_states());
  const auto exact = scores_of(states);
  scores.crps = exact.crps;
  scores.coverage = exact.coverage;
  if (noise.empty()) {
    compare(rows, states, scores);
    return scores;
  }
  const auto recorded =
      by_rollout(observation.states(), target.num_rollouts(), target.num_states());
  scores.log_score = log_score(model, rows, recorded, noise);
  parallel_for(rows.num_rows, [&](Index i) {
    if (!is_ok(rows, i)) return;
    Stream stream(row_after(within(id, "prediction_noise"), i));
    model.add(rows.row(i), noise[static_cast<std::size_t>(i)], stream);
  });
  const auto noisy = scores_of(recorded);
  scores.noisy_crps = noisy.crps;
  scores.noisy_coverage = noisy.coverage;
  compare(rows, recorded, scores);
  return scores;
}

RowMatrix values_of(double sim::NoiseValues::*parameter, const NoiseOfSamples& noise,
                    const sim::Trajectories& seen) {
  RowMatrix values(std::ssize(noise), seen.num_states);
  for (Index i = 0; i < values.rows(); ++i) {
    for (Index c = 0; c < values.cols(); ++c) {
      const sim::NoiseValues& its = noise[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
      values(i, c) = is_ok(seen, i) ? its.*parameter : kNaN;
    }
  }
  return values;
}

}  // namespace

NoiseSource noise_source(const Plan& plan, const Node& posterior) {
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  const auto certificate = read_part<inference::ImportanceCertificate>(file);
  if (!certificate) return {.infers_first_states = read_part<FittedStates>(file).has_value()};
  return {certificate->power,
          read_part<PowerScores>(file).value_or(PowerScores()).noise_factor_at(certificate->power),
          plan.study.method(posterior.uses.front().method).refine.infer_first_states};
}

NoiseOfSamples draw_noise(const Observation& observation, const sim::Trajectories& simulated,
                          const NoiseSource& source, const StreamId& id) {
  if (observation.study().observation_noise.is_silent()) return {};
  const Target& target = observation.target();
  const Index store_every = observation.study().simulator.store_every;
  const bool is_stored = simulated.num_steps == target.num_steps() / store_every;
  const sim::Trajectories rows =
      stored(simulated, target.num_rollouts(), is_stored ? 1 : store_every);
  const sim::NoiseModel& given = observation.noise();
  const sim::NoiseModel model = source.infers_first_states ? given.with_unknown_scales() : given;
  NoiseOfSamples noise(static_cast<std::size_t>(rows.num_rows));
  if (!model.has_unknown()) {
    Stream unused(id);
    std::ranges::fill(noise, model.draw_values(unused));
    return noise;
  }
  const sim::NoiseLikelihood likelihood(model, observation.states());
  const std::optional<inference::Resampler> others = other_samples(likelihood, rows, source.power);
  parallel_for(rows.num_rows, [&](Index i) {
    Stream stream(row_after(within(id, "noise_values"), i));
    const Index other = others ? others->draw(stream.uniform()) : i;
    // A sample that failed here may predict other rollouts well.
    noise[static_cast<std::size_t>(i)] = model.with_unknown_scales_times(
        source.factor, is_ok(rows, other) ? likelihood.draw_values(rows.row(other), stream)
                                          : model.draw_values(stream));
  });
  return noise;
}

NoiseOfSamples draw_prior_noise(const Observation& observation, Index num_samples,
                                const StreamId& id) {
  if (observation.study().observation_noise.is_silent()) return {};
  const sim::NoiseModel& model = observation.noise();
  NoiseOfSamples noise;
  for (Index i = 0; i < num_samples; ++i) {
    Stream stream(row_after(within(id, "noise_values"), i));
    noise.push_back(model.draw_values(stream));
  }
  return noise;
}

std::optional<InferredNoise> inferred_noise(const sim::NoiseModel& model,
                                            const NoiseOfSamples& noise,
                                            const sim::Trajectories& seen) {
  if (noise.empty() || !model.has_unknown()) return std::nullopt;
  InferredNoise inferred{values_of(&sim::NoiseValues::scale, noise, seen), {}, {}};
  if (std::ranges::any_of(model.channels(), &sim::ChannelNoise::is_correlated)) {
    inferred.correlation = values_of(&sim::NoiseValues::correlation, noise, seen);
  }
  if (std::ranges::any_of(model.channels(), &sim::ChannelNoise::is_heavy_tailed)) {
    inferred.degrees_of_freedom = values_of(&sim::NoiseValues::degrees_of_freedom, noise, seen);
  }
  return inferred;
}

RolloutScores score(const Judge& judge, const PredictedRollouts& predicted,
                    const NoiseOfSamples& noise, const StreamId& id) {
  RolloutScores scores{score_part(judge.seen().observation(), predicted.seen, noise, id), {}};
  if (judge.held_out() == nullptr) return scores;
  scores.held_out = score_part(judge.held_out()->observation(), predicted.held_out, noise,
                               within(id, "held_out_simulation"));
  return scores;
}

}  // namespace npdr::pipeline
