#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/error.h"
#include "core/stop_request.h"
#include "inference/algorithms/posterior_estimation.h"
#include "pipeline/artefacts/network_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/features/observation.h"
#include "pipeline/features/simulation_features.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stage_parts.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

using TrainingCheckpoints = Checkpoints<TrainingCheckpoint>;

// Shapes that don't go together are a bug, unless they come from a checkpoint.
template <class Work>
auto blaming_checkpoint(const std::filesystem::path& path, const Work& work) {
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
  // Goes on from `earlier`.
  EpochReport(const Node& node, TrainingCheckpoints& checkpoints, TrainingCheckpoint earlier)
      : progress_(node.label() + ", epoch", 0),
        checkpoints_(checkpoints),
        now_(std::move(earlier)) {}

  bool operator()(Index network, const inference::TrainingState& state) {
    const auto number = static_cast<std::size_t>(network);
    std::vector<inference::TrainingState>& states = now_.trainings;
    states.resize(std::max(states.size(), number + 1));
    states[number] = state;
    // Saved before it is shown: who looks at the progress may be gone.
    const bool is_stopping = stop_requested();
    if (is_stopping || checkpoints_.is_due()) checkpoints_.save(now_);
    Index epochs = 0;
    for (const inference::TrainingState& each : states) epochs += each.epoch;
    const std::string which = states.size() > 1 ? fmt::format("network {}, ", network + 1) : "";
    progress_.update(epochs, fmt::format("{}loss {:.4g}", which, state.validation_loss.back()));
    return !is_stopping;
  }

 private:
  Progress progress_;
  TrainingCheckpoints& checkpoints_;
  TrainingCheckpoint now_;
};

// Trains the networks on all rounds' simulations.
void infer_network(const Plan& plan, const Node& node, ArtefactWriter& writer) {
  TrainingCheckpoints checkpoints(plan, node, kCheckpointSchema);
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  const Observation observation(plan.study, read_seen_target(plan, node));
  const auto embedding = inference::make_embedding(method.embedding, observation.target(),
                                                   plan.study.simulator.store_every);
  const SimulationFeatures features(plan, plan.inputs(node, "simulation"), observation, *embedding);
  const inference::Prior prior(plan.study.prior);
  const inference::SeriesSelection& series = embedding->selection();
  auto config =
      estimation_config(method, {series.num_rollouts, series.num_steps(), series.num_channels()});
  if (method.embedding.shape.empty()) config.tails = plan.study.tails();

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

  TrainingCheckpoint checkpoint = checkpoints.read();
  writer.add_cost(checkpoint.cost);
  EpochReport report(node, checkpoints, checkpoint);
  const auto posterior = blaming_checkpoint(checkpoints.file().path, [&] {
    return inference::estimate_posterior(config, data,
                                         {use.seed, "training", use.stream_round(), 0, 0},
                                         checkpoint.trainings, std::ref(report));
  });
  if (!posterior) checkpoints.stop();

  // Fewer than a diagnosis compares with, as each posterior holds them.
  constexpr Index most_usual = 1000;
  const StreamId picks{use.seed, "usual_features", use.stream_round(), 0, 0};
  write_posterior(writer.file(), method, *posterior, observation.target(), checkpoint.trainings,
                  {features.num_rows(), features.num_failed()},
                  usual_features_of(features, config.tails, most_usual, picks));
}

}  // namespace

template <>
void run<Stage::infer>(const Plan& plan, const Node& node, const std::vector<Index>&) {
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
    case inference::AlgorithmFamily::fit:
      infer_least_squares(plan, node, writer.file());
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
