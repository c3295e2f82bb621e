#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>
#include <tuple>

#include "core/constants.h"
#include "core/error.h"
#include "core/quantile.h"
#include "core/stop_request.h"
#include "inference/diagnostics/calibration.h"
#include "inference/diagnostics/excess_width.h"
#include "pipeline/artefacts/diagnosis_file.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/config/check.h"
#include "pipeline/features/failures.h"
#include "pipeline/features/first_states.h"
#include "pipeline/features/observation.h"
#include "pipeline/features/simulation_features.h"
#include "pipeline/predictions/scores.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stage_parts.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

using inference::NetworkPosterior;

// Fresh simulations of the prior, and where their truths rank among samples of the network of round
// 1, which has learned from the whole prior.
struct Calibration {
  std::unique_ptr<NetworkPosterior> posterior;
  Index num_failed = 0;
  RowMatrix theta;  // (n, D)
  RowMatrixF x;     // (n, F)
  inference::CalibrationRanks ranks;
};

// Predictions of posterior samples, as the inference would see them, those that succeeded.
struct Predictions {
  std::vector<Index> rows = {};  // (n) of samples that succeeded
  RowMatrix theta = {};          // (n, D)
  RowMatrix summaries = {};      // (n, S)
  RowMatrixF features = {};      // (n, F)
  Index num_failed = 0;
  bool is_random = false;  // whether simulations of the same sample differ
};

// Inputs that the checks of one method and seed share.
struct Case {
  const Plan& plan;
  const Node& node;
  const MethodConfig& method;
  Observation observation;
  DiagnoseConfig config;
  std::unique_ptr<inference::Embedding> embedding = nullptr;
  VectorF x_o = {};
  Calibration calibration = {};  // where any check calibrates
  Predictions predictions = {};  // where any check predicts

  const Node& last_posterior() const { return plan.input(node, "posterior"); }
  // Of round 1, which has learned from the whole prior.
  const Node& first_posterior() const {
    const Node* first = plan.find_input(node, numbered("posterior", 1));
    return first != nullptr ? *first : last_posterior();
  }
  StreamId stream(std::string_view name) const { return {node.uses.front().seed, name, 0, 0, 0}; }
};

Case make_case(const Plan& plan, const Node& node) {
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  Case c{.plan = plan,
         .node = node,
         .method = method,
         .observation = {plan.study, read_seen_target(plan, node)},
         .config = plan.study.diagnose_of(method).of_diagnosis()};
  c.embedding = inference::make_embedding(method.embedding, c.observation.target(),
                                          plan.study.simulator.store_every);
  c.x_o = c.observation.x_o(*c.embedding);
  return c;
}

Calibration calibrate(const Case& c, ArtefactWriter& writer) {
  const SimulationFeatures features(c.plan, std::vector{&c.plan.input(c.node, "calibration")},
                                    c.observation, *c.embedding);
  if (features.num_rows() < inference::kFewestSimulations) {
    throw InputError(fmt::format(
        "{}: {} simulations of calibration and {} failed ones, must be at least {} good ones; "
        "raise diagnose.num_simulations",
        c.node.label(), features.num_rows(), features.num_failed(), inference::kFewestSimulations));
  }
  std::vector<std::uint32_t> all(static_cast<std::size_t>(features.num_rows()));
  std::iota(all.begin(), all.end(), 0u);
  Calibration made{
      read_network_posterior(c.first_posterior()), features.num_failed(), features.theta(), {}, {}};
  features.gather(all, 0, made.x);
  Checkpoints checkpoints(c.plan, c.node, kDiagnosisCheckpointSchema);
  DiagnosisCheckpoint earlier =
      read_diagnosis_checkpoint(checkpoints.file(), made.theta, c.config.num_samples);
  writer.add_cost(earlier.cost);
  Progress progress(c.node.label(), features.num_rows(), earlier.ranks.num_done);
  const auto report = [&](const inference::CalibrationRanks& ranks) {
    const bool is_stopping = stop_requested();
    if (is_stopping || checkpoints.is_due()) checkpoints.save({ranks, earlier.cost});
    progress.update(ranks.num_done);  // saved before it is shown
    if (is_stopping) checkpoints.stop();
  };
  made.ranks = inference::rank_truths(
      [&](const VectorF& observed) { return made.posterior->given(observed); }, made.theta, made.x,
      std::move(earlier.ranks), c.stream(""), report);
  return made;
}

Vector spread(const Case& c, const VectorX<std::int64_t>& ranks, std::string_view name,
              Index column = 0) {
  StreamId id = c.stream(name);
  id.epoch = static_cast<std::uint64_t>(column);
  return inference::spread_ranks({ranks.begin(), ranks.end()}, c.config.num_samples, id);
}

CoverageResult coverage_of(const Case& c, const VectorX<std::int64_t>& ranks,
                           std::string_view name) {
  CoverageResult result{ranks, spread(c, ranks, name), {}};
  result.coverage = inference::measure_coverage(result.levels);
  return result;
}

SbcResult check_ranks(const Case& c) {
  const RowMatrixX<std::int64_t>& ranks = c.calibration.ranks.parameter;
  SbcResult result{ranks, RowMatrix(ranks.rows(), ranks.cols()), {}};
  for (Index d = 0; d < ranks.cols(); ++d) {
    result.levels.col(d) = spread(c, ranks.col(d), "diagnose_sbc", d);
  }
  result.test = inference::test_sbc(result.levels);
  return result;
}

inference::LocalC2st check_at_x_o(const Case& c) {
  const auto& [posterior, num_failed, theta, x, ranks] = c.calibration;
  const inference::Prior& prior = posterior->prior();
  const RowMatrix at_x_o =
      posterior->sample(c.config.num_samples, c.stream("diagnose_local_c2st_samples"));
  return inference::local_c2st(
      {prior.to_normal(theta), prior.to_normal(ranks.theta), x, prior.to_normal(at_x_o), c.x_o},
      c.stream("diagnose_local_c2st"));
}

// The target; of a fit that found the first states, too, it begins in these.
Target predicted_target(const Case& c) {
  const Target& target = c.observation.target();
  const auto fitted = read_part<FittedStates>(open_artefact(c.last_posterior(), kPosteriorSchema));
  if (!fitted) return target;
  return begun_in(fitted->states, segment_starts(c.plan.study.simulator, target.num_steps()),
                  target);
}

sim::Trajectories simulate(const Case& c, const RowMatrix& theta) {
  constexpr Index block = 256;
  const auto simulator =
      c.plan.source->open({c.plan.study.simulator, predicted_target(c), log_of(c.node.path)});
  sim::Trajectories rows;
  for (Index begin = 0; begin < theta.rows(); begin += block) {
    stop_here_if_requested();
    const Index count = std::min(block, theta.rows() - begin);
    StreamId first = c.stream("diagnose_predictive_simulation");
    first.row = static_cast<std::uint64_t>(begin);
    rows.append(simulator->simulate(
        c.plan.source->parameters().complete(theta.middleRows(begin, count)), first));
  }
  return rows;
}

Predictions predict(const Case& c, const RowMatrix& theta) {
  const sim::Trajectories rows = simulate(c, theta);
  const inference::SeriesSelection& selection = c.embedding->selection();
  const sim::NoiseModel& noise = c.observation.noise();
  const sim::NoiseModel picked_noise = c.observation.noise_of(selection);
  // Its prior would let anything pass.
  NoiseOfSamples unknown;
  if (noise.has_unknown()) {
    unknown = draw_noise(c.observation, rows, noise_source(c.plan, c.last_posterior()),
                         c.stream("diagnose_predictive_noise"));
  }
  std::vector<float> picked(static_cast<std::size_t>(selection.num_values()));
  Predictions result{.features = {theta.rows(), c.embedding->num_features()}};
  Index next = 0;
  for (Index i = 0; i < rows.num_rows; ++i) {
    if (rows.status[static_cast<std::size_t>(i)] != sim::RolloutStatus::ok) continue;
    StreamId id = c.stream("diagnose_predictive_noise");
    id.row = static_cast<std::uint64_t>(i);
    Stream stream(id);
    if (unknown.empty()) {
      selection.pick(rows.row(i), picked);
      if (!picked_noise.is_silent()) picked_noise.add(picked, selection.stride, stream);
    } else {
      std::vector<float> noisy(rows.row(i).begin(), rows.row(i).end());
      noise.add(noisy, unknown[static_cast<std::size_t>(i)], stream);
      selection.pick(noisy, picked);
    }
    const Vector summary = summarize(picked, selection);
    if (next == 0) result.summaries.resize(theta.rows(), summary.size());
    result.summaries.row(next) = summary.transpose();
    result.rows.push_back(i);
    c.embedding->embed(picked, {result.features.row(next).data(),
                                static_cast<std::size_t>(result.features.cols())});
    ++next;
  }
  result.summaries.conservativeResize(next, Eigen::NoChange);
  result.features.conservativeResize(next, Eigen::NoChange);
  return result;
}

// Of posterior samples; the first ones are simulated twice.
Predictions predict(const Case& c) {
  const RowMatrix theta = read_posterior(c.last_posterior())
                              ->sample(c.config.num_samples, c.stream("diagnose_predictive"));
  const Index num_again = std::min<Index>(theta.rows(), 10);
  RowMatrix all(theta.rows() + num_again, theta.cols());
  all << theta, theta.topRows(num_again);
  Predictions made = predict(c, all);
  const auto kept = std::ranges::lower_bound(made.rows, theta.rows()) - made.rows.begin();
  for (auto i = static_cast<std::size_t>(kept); i < made.rows.size(); ++i) {
    const auto first = std::ranges::lower_bound(made.rows, made.rows[i] - theta.rows());
    if (*first != made.rows[i] - theta.rows()) continue;
    const Index row = first - made.rows.begin(), again = static_cast<Index>(i);
    made.is_random |= made.features.row(row) != made.features.row(again);
  }
  made.rows.resize(static_cast<std::size_t>(kept));
  made.theta = theta(made.rows, Eigen::all);
  made.summaries.conservativeResize(kept, Eigen::NoChange);
  made.features.conservativeResize(kept, Eigen::NoChange);
  made.num_failed = theta.rows() - kept;
  return made;
}

std::optional<WidthResult> check_width(const Case& c) {
  const Predictions& p = c.predictions;
  if (p.theta.rows() < inference::kFewestForWidth || !p.features.allFinite()) return std::nullopt;
  if (!p.is_random) return WidthResult{Vector::Zero(p.theta.cols()), false};
  return WidthResult{inference::excess_width(p.theta, p.features), true};
}

PredictiveResult check_predictions(const Case& c) {
  const Predictions& predictions = c.predictions;
  const inference::SeriesSelection& selection = c.embedding->selection();
  PredictiveResult result;
  result.names = summary_names(selection, c.observation.target().state_channels);
  result.observed = summarize(c.observation.picked(selection), selection);
  result.num_failed = predictions.num_failed;
  result.median.setConstant(result.observed.size(), kNaN);
  // A posterior whose samples can't be simulated doesn't predict what was observed.
  if (predictions.features.rows() < inference::kFewestSimulations) {
    result.check.summary_p_value.setZero(result.observed.size());
    result.check.p_value = 0.0;
    return result;
  }
  for (Index s = 0; s < result.median.size(); ++s) {
    result.median(s) = upper_median(Vector(predictions.summaries.col(s)));
  }
  result.check = inference::check_prediction(predictions.summaries, result.observed,
                                             predictions.features, c.x_o);
  return result;
}

// Among what the network of the last round was trained on; none where that is too little to tell.
std::optional<inference::OutOfDistribution> check_observation(const Case& c) {
  constexpr Index most_rows = 4000;
  const SimulationFeatures features(c.plan, c.plan.inputs(c.node, "simulation"), c.observation,
                                    *c.embedding);
  const auto usual =
      usual_features_of(features, c.plan.study.tails(), most_rows, c.stream("usual_features"));
  if (!usual) return std::nullopt;
  return inference::test_out_of_distribution(*usual, c.x_o);
}

// What a check adds to the diagnosis.
struct CheckRun {
  Check check;
  void (*run)(const Case& c, Diagnosis& diagnosis);
};

constexpr CheckRun kCheckRuns[] = {
    {Check::sbc, [](const Case& c, Diagnosis& d) { d.sbc = check_ranks(c); }},
    {Check::coverage,
     [](const Case& c, Diagnosis& d) {
       d.coverage = coverage_of(c, c.calibration.ranks.density, "diagnose_coverage");
     }},
    {Check::tarp,
     [](const Case& c, Diagnosis& d) {
       d.tarp = coverage_of(c, c.calibration.ranks.distance, "diagnose_tarp");
     }},
    {Check::local_c2st, [](const Case& c, Diagnosis& d) { d.local_c2st = check_at_x_o(c); }},
    {Check::predictive, [](const Case& c, Diagnosis& d) { d.predictive = check_predictions(c); }},
    {Check::width, [](const Case& c, Diagnosis& d) { d.width = check_width(c); }},
    {Check::ood, [](const Case& c, Diagnosis& d) { d.ood = check_observation(c); }},
    {Check::failures,
     [](const Case& c, Diagnosis& d) {
       d.failures = test_failures(c.plan, c.plan.inputs(c.node, "simulation"));
     }},
    {Check::training,
     [](const Case& c, Diagnosis& d) {
       d.training =
           check_training_curves(read_posterior_notes(c.last_posterior()), c.method.training);
       d.max_epochs = c.method.training.max_epochs;
     }},
};

static_assert(std::ranges::all_of(enum_table(Check{}), [](const CheckTraits& row) {
  return (row.input == CheckInput::samples) ==
         std::ranges::none_of(kCheckRuns, [&](const CheckRun& c) { return c.check == row.value; });
}));

}  // namespace

inference::TrainingCheck check_training_curves(const PosteriorNotes& notes,
                                               const inference::TrainingConfig& config) {
  std::vector<inference::TrainingCheck> checks;
  const auto check = [&](const TrainingLosses& losses) {
    return inference::check_training(losses.training, losses.validation, config);
  };
  std::ranges::transform(notes.losses, std::back_inserter(checks), check);
  if (notes.pool && notes.pool->powers.likelihood > 0.0) {
    for (const TrainingLosses& losses : notes.likelihood_losses) {
      if (const auto found = check(losses); !found.is_converged) checks.push_back(found);
    }
  }
  const auto is_better = [](const auto& a, const auto& b) {
    return std::tuple(!a.is_converged, a.generalization_gap) <
           std::tuple(!b.is_converged, b.generalization_gap);
  };
  return *std::ranges::max_element(checks, is_better);
}

template <>
void run<Stage::diagnose>(const Plan& plan, const Node& node, const std::vector<Index>&) {
  ArtefactWriter writer(node.path, kDiagnosisSchema, node.identity);
  Case c = make_case(plan, node);
  Diagnosis diagnosis;
  diagnosis.num_samples = c.config.num_samples;
  if (c.config.calibrates()) {
    c.calibration = calibrate(c, writer);
    diagnosis.num_simulations = c.calibration.theta.rows();
    diagnosis.num_failed = c.calibration.num_failed;
    diagnosis.truth_log_prob = c.calibration.ranks.log_prob;
  }
  if (c.config.has(Check::predictive) || c.config.has(Check::width)) c.predictions = predict(c);
  for (const auto& [check, run] : kCheckRuns) {
    if (c.config.has(check)) run(c, diagnosis);
  }
  diagnosis.parameters = plan.study.prior;
  kDiagnosisSchema.write(writer.file(), std::move(diagnosis));
  writer.finish();
}

}  // namespace npdr::pipeline
