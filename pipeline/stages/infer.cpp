#include "inference/algorithms/posterior_estimation.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "core/stop_request.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/simulation_features.h"
#include "pipeline/features/targets.h"
#include "pipeline/features/usual_features.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/checkpoint_times.h"
#include "pipeline/stages/infer_methods.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Shapes that don't go together are a bug, unless they come from a checkpoint.
template <class Work>
auto blaming_checkpoint(const Plan& plan, const Node& node, const Work& work) {
  const std::filesystem::path path = plan.work.checkpoint("infer", node.key);
  const bool is_there = std::filesystem::exists(path);
  try {
    return work();
  } catch (const ShapeError& error) {
    if (!is_there) throw;
    throw InputError(path.string() + ": " + error.what() + "; remove it and rerun stage 'infer'");
  }
}

// After each epoch of a network: progress, now and then a checkpoint with the last states of all,
// and one more when asked to stop.
class EpochReport {
 public:
  // `start`: of the stage; `earlier`: what the runs that this one goes on from left.
  EpochReport(const Plan& plan, const Node& node, Clock::time_point start,
              const TrainingCheckpoint& earlier)
      : plan_(plan),
        node_(node),
        progress_(node.label() + ", epoch", 0),
        start_(start),
        earlier_(earlier.cost),
        states_(earlier.trainings) {}

  bool operator()(Index network, const inference::TrainingState& state) {
    const auto number = static_cast<std::size_t>(network);
    states_.resize(std::max(states_.size(), number + 1));
    states_[number] = state;
    const auto now = Clock::now();
    const bool is_due = seconds_between(saved_, now) > kSecondsBetweenCheckpoints;
    // Saved before it is shown: who looks at the progress may be gone.
    const bool is_stopping = stop_requested();
    if (is_due || is_stopping) {
      saved_ = now;
      TrainingCheckpoint checkpoint{states_, earlier_};
      checkpoint.cost += cost_of_seconds(seconds_between(start_, now));
      kCheckpointSchema.write(plan_.work.checkpoint("infer", node_.key), node_.identity,
                              std::move(checkpoint));
    }
    Index epochs = 0;
    for (const inference::TrainingState& each : states_) epochs += each.epoch;
    const std::string which = states_.size() > 1 ? fmt::format("network {}, ", network + 1) : "";
    progress_.update(epochs, fmt::format("{}loss {:.4g}", which, state.validation_loss.back()));
    return !is_stopping;
  }

 private:
  const Plan& plan_;
  const Node& node_;
  Progress progress_;
  Clock::time_point start_;
  Cost earlier_;
  std::vector<inference::TrainingState> states_;
  Clock::time_point saved_ = Clock::now();
};

// Trains the networks on all rounds' simulations.
void infer_network(const Plan& plan, const Node& node, ArtefactWriter& writer) {
  const auto start = Clock::now();
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  const Observation observation(plan.study, read_seen_target(plan, node));
  const auto embedding = inference::make_embedding(method.embedding, observation.target(),
                                                   plan.study.simulator.store_every);
  const SimulationFeatures features(plan, node, observation, *embedding);
  const inference::Prior prior(plan.study.prior);
  const inference::SeriesSelection& series = embedding->selection();
  auto config =
      estimation_config(method, {series.num_rollouts, series.num_steps(), series.num_channels()});
  config.tails = plan.study.tails();

  inference::RoundData data;
  data.prior = &prior;
  data.x = &features;
  data.theta = features.theta();
  data.round = features.rounds();
  data.num_simulated = features.num_simulated();
  data.x_o = observation.x_o(*embedding);
  for (const Node* posterior : plan.inputs(node, "posterior")) {
    data.posteriors.push_back(read_network_posterior(*posterior));
  }

  TrainingCheckpoint checkpoint =
      kCheckpointSchema.read_if_there({plan.work.checkpoint("infer", node.key), node.key})
          .value_or(TrainingCheckpoint());
  writer.add_cost(checkpoint.cost);
  EpochReport report(plan, node, start, checkpoint);
  const auto posterior = blaming_checkpoint(plan, node, [&] {
    return inference::estimate_posterior(config, data,
                                         {use.seed, "training", use.stream_round(), 0, 0},
                                         checkpoint.trainings, std::ref(report));
  });
  if (!posterior) throw Checkpointed(node.label() + ": stopped on request, checkpoint written");

  // Fewer than a diagnosis compares with, as each posterior holds them.
  constexpr Index most_usual = 1000;
  const StreamId picks{use.seed, "usual_features", use.stream_round(), 0, 0};
  write_posterior(writer.file(), method, *posterior, observation.target(), checkpoint.trainings,
                  {features.num_rows(), features.num_failed()},
                  usual_features_of(features, config.tails, most_usual, picks));
}

}  // namespace

void run_infer(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kPosteriorSchema, node.identity);
  const MethodConfig& method = plan.study.method(node.uses.front().method);
  switch (inference::traits_of(method.algorithm.kind).family) {
    case inference::AlgorithmFamily::network:
      infer_network(plan, node, writer);
      break;
    case inference::AlgorithmFamily::abc:
      infer_abc(plan, node, writer.file());
      break;
    case inference::AlgorithmFamily::regression:
      infer_regression(plan, node, writer.file());
      break;
    case inference::AlgorithmFamily::likelihood:
      infer_refined(plan, node, writer);
      break;
    case inference::AlgorithmFamily::fixed:
      throw Error(node.label() + ": there is nothing to infer");  // the plan has no such node
  }
  writer.finish();
}

}  // namespace npdr::pipeline
