#include "pipeline/predictions/misfit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "analysis/scatter.h"
#include "core/constants.h"
#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/predictions/prediction.h"
#include "pipeline/sources/source.h"

namespace npdr::pipeline {
namespace {

// Noise over sigma, (H K, C): white where its scale isn't given.
std::vector<RowMatrix> draw_errors(const sim::NoiseModel& model, const RecordedNoise& noise) {
  constexpr Index num_draws = 32;
  const Index steps = model.num_steps(), channels = model.num_states();
  std::vector<RowMatrix> draws;
  for (Index b = 0; b < num_draws; ++b) {
    Stream stream({0, "misfit_noise", 0, static_cast<std::uint64_t>(b), 0});
    RowMatrix draw(model.num_rollouts() * steps, channels);
    if (!noise.is_given) {
      for (double& error : draw.reshaped<Eigen::RowMajor>()) error = stream.normal();
    } else {
      std::vector<float> series(static_cast<std::size_t>(draw.size()));
      model.add(series, model.draw_values(stream), stream);
      draw = Eigen::Map<const RowMatrixF>(series.data(), draw.rows(), channels).cast<double>();
      for (Index i = 0; i < draw.rows(); ++i) {
        draw.row(i) = draw.row(i).cwiseQuotient(noise.sigma.row(i / steps)).eval();
      }
    }
    draws.push_back(std::move(draw));
  }
  return draws;
}

// sqrt(1 - p / N) of N errors and p values that a fit has chosen.
double size_of_right(const analysis::Fit& fit) {
  constexpr double least = 0.1;
  const auto chosen = static_cast<double>(fit.theta.size() + fit.first_states.size());
  return std::sqrt(std::max(least, 1.0 - chosen / static_cast<double>(fit.errors.size())));
}

double limit_of(const Study& study, bool is_given) {
  if (!is_given) return kMostOfScatter;
  return study.observation_noise.is_correlated() ? kMostOfCorrelatedNoise : kMostOfGivenNoise;
}

// Whether rows of the same parameters, which have seeds of their own, differ by more than a
// thousandth of the noise. Then slopes aren't those of parameters, and what a simulation draws
// counts as its error.
bool draws_at_random(const analysis::Replay& replay, const Observation& observation,
                     const Vector& theta, const RecordedNoise& noise) {
  constexpr double least = 1e-3;
  const Target& target = observation.target();
  const Index segment = observation.study().simulator.segment_length;
  const RowMatrix twice =
      replay(target, segment > 0 ? segment : target.num_steps(), theta.transpose().replicate(2, 1));
  const Index channels = target.num_states();
  const Index per_rollout = twice.cols() / target.num_rollouts();
  for (Index j = 0; j < twice.cols(); ++j) {
    const double difference = std::abs(twice(0, j) - twice(1, j));
    if (difference > least * noise.sigma(j / per_rollout, j % channels)) return true;
  }
  return false;
}

}  // namespace

bool can_cut_rollouts(const Plan& plan) {
  const SourceTraits& source = plan.study.source();
  if (!source.is_built_in) return true;
  const auto unused = sim::unused_settings(plan.study.simulator.name);
  return std::ranges::count(unused, "segment_length") == 0;
}

RecordedNoise recorded_noise(const Observation& observation) {
  constexpr double least = 1e-3;
  const sim::NoiseModel& model = observation.noise();
  const Target& target = observation.target();
  RecordedNoise noise{model.relative_size()};
  for (Index c = 0; c < target.num_states(); ++c) {
    const sim::NoiseParameter& scale = model.channels()[static_cast<std::size_t>(c)].scale;
    if (!scale.is_unknown() && scale.median > 0.0) continue;
    noise.is_given = false;
    double scatter = 0.0;
    for (Index h = 0; h < target.num_rollouts(); ++h) {
      const Vector states = target.rollouts[static_cast<std::size_t>(h)].states.col(c);
      scatter += analysis::scatter(states) / model.measure()(h, c);
    }
    noise.sigma.col(c).setConstant(scatter / static_cast<double>(target.num_rollouts()));
  }
  noise.sigma = noise.sigma.cwiseMax(least).cwiseProduct(model.measure());
  return noise;
}

std::optional<RecordingMisfit> find_misfit(const Plan& plan, const Observation& observation,
                                           const Vector& theta, const std::filesystem::path& log) {
  constexpr double num_deviations = 5.0;
  const sim::SimulatorConfig& simulator = plan.study.simulator;
  const Target& recording = observation.target();
  const analysis::Replay replay = [&](const Target& target, Index segment_length,
                                      const RowMatrix& rows) -> RowMatrix {
    sim::SimulatorConfig config = simulator;
    config.segment_length = segment_length < target.num_steps() ? segment_length : 0;
    const Index steps = target.num_steps() / config.store_every;
    const Index size = target.num_rollouts() * steps * target.num_states();
    stop_here_if_requested();
    try {
      const sim::Trajectories simulated =
          plan.source->open({config, target, log})
              ->simulate(plan.source->parameters().complete(rows), {0, "misfit", 0, 0, 0});
      return Eigen::Map<const RowMatrixF>(simulated.values.data(), rows.rows(), size)
          .cast<double>();
    } catch (const Checkpointed&) {
      throw;
    } catch (const Error&) {  // as of another time step, or segments, that a program refuses
      return RowMatrix::Constant(rows.rows(), size, kNaN);
    }
  };
  const RecordedNoise noise = recorded_noise(observation);
  const ObservationNoise& stated = plan.study.observation_noise;
  if (!noise.is_given && (stated.is_correlated() || stated.is_heavy_tailed())) return std::nullopt;
  if (plan.study.source().takes_seeds && draws_at_random(replay, observation, theta, noise)) {
    return std::nullopt;
  }
  const SearchBox box = search_box(plan.study.prior, plan.source->info());
  const analysis::FitProblem problem{replay,
                                     box.lower,
                                     box.upper,
                                     noise.sigma,
                                     simulator.store_every,
                                     simulator.segment_length,
                                     can_cut_rollouts(plan) ? analysis::kFitParts : 1};
  const analysis::Fit fit = analysis::fit(problem, recording, theta);
  if (fit.errors.size() == 0) return std::nullopt;
  RecordingMisfit found{analysis::misfit(fit.errors, draw_errors(observation.noise(), noise),
                                         recording.num_rollouts()),
                        noise.is_given, limit_of(plan.study, noise.is_given)};
  found.expected = size_of_right(fit);
  found.limit = std::max(found.limit, 1.0 + num_deviations * found.deviation);
  if (!found.is_beyond() || plan.study.source().calls_program) return found;
  if (const auto cause = analysis::likeliest_cause(problem, recording, fit.theta)) {
    const double left = analysis::size_of(fit.errors, recording.num_rollouts());
    found.cause = cause->fault;
    found.change = cause->change;
    found.times_of_cause = found.times * cause->size / left;
  }
  return found;
}

}  // namespace npdr::pipeline
