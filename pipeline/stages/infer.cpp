#include "inference/algorithms/posterior_estimation.h"

#include <fmt/format.h>

#include <chrono>

#include "core/error.h"
#include "pipeline/plan/schemas.h"
#include "pipeline/run/progress.h"
#include "pipeline/run/stop_request.h"
#include "pipeline/stages/posterior_file.h"
#include "pipeline/stages/simulation_features.h"
#include "pipeline/stages/simulation_file.h"
#include "pipeline/stages/stage_files.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

constexpr double kSecondsBetweenCheckpoints = 60.0;

// The mixtures that rounds 2, 3, ... were drawn from, when the loss corrects for them.
std::vector<inference::GaussianMixture> read_proposals(
    const inference::PosteriorEstimationConfig& config,
    const std::vector<const Node*>& posteriors) {
  std::vector<inference::GaussianMixture> proposals;
  if (inference::resolve_loss(config.algorithm, config.estimator) != "analytic") return proposals;
  for (const Node* node : posteriors) {
    proposals.push_back(inference::proposal_mixture(read_posterior(*node)));
  }
  return proposals;
}

// After each epoch: progress, a checkpoint now and then, and one more when asked to stop.
class EpochReport {
 public:
  EpochReport(const Plan& plan, const Node& node)
      : plan_(plan), node_(node), progress_(node.label() + ", epoch", 0) {}

  bool operator()(const inference::TrainingState& state) {
    progress_.update(state.epoch, fmt::format("loss {:.4g}", state.validation_loss.back()));
    const auto now = std::chrono::steady_clock::now();
    const bool is_due =
        std::chrono::duration<double>(now - saved_).count() > kSecondsBetweenCheckpoints;
    if (!is_due && !stop_requested()) return true;
    write_checkpoint(plan_, node_, state);
    saved_ = now;
    return !stop_requested();
  }

 private:
  const Plan& plan_;
  const Node& node_;
  Progress progress_;
  std::chrono::steady_clock::time_point saved_ = std::chrono::steady_clock::now();
};

}  // namespace

void run_infer(const Plan& plan, const Node& node) {
  ArtefactWriter writer(node.path, kPosteriorSchema, node.identity);
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  for (const Node* simulation : plan.inputs(node, Stage::simulate)) {
    check_failed_rows(plan, *simulation);
  }
  const Target target = read_target(plan, node, method.num_rollouts);
  const auto embedding =
      inference::make_embedding(method.embedding, target, plan.study.simulator.store_every);
  const SimulationFeatures features(plan, node, target, *embedding);
  const inference::Prior prior(plan.study.prior);
  const auto config = estimation_config(method);
  const auto posteriors = plan.inputs(node, Stage::infer);

  inference::RoundData data;
  data.prior = &prior;
  data.x = &features;
  data.theta = features.theta();
  data.round = features.rounds();
  data.proposals = read_proposals(config, posteriors);
  data.x_o = observation(plan, target, *embedding);
  std::optional<inference::DirectPosterior> previous;
  if (!posteriors.empty()) previous = read_posterior(*posteriors.back());

  inference::TrainingState state = read_checkpoint(plan, node);
  EpochReport report(plan, node);
  const auto posterior = inference::estimate_posterior(
      config, data, previous ? &*previous : nullptr,
      {use.seed, "training", static_cast<std::uint64_t>(use.round), 0, 0}, state, std::ref(report));
  if (!posterior) throw Checkpointed(node.label() + ": stopped on request, checkpoint written");

  write_posterior(writer.file(), method, *posterior, target, state,
                  {features.num_rows(), features.num_failed()});
  writer.finish();
  std::filesystem::remove(plan.work.checkpoint("infer", node.key));
}

}  // namespace npdr::pipeline
