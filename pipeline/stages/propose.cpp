#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/random.h"
#include "inference/abc/abc.h"
#include "inference/algorithms/posterior_estimation.h"
#include "pipeline/artefacts/particle_file.h"
#include "pipeline/artefacts/policy_file.h"
#include "pipeline/artefacts/posterior_file.h"
#include "pipeline/artefacts/recording.h"
#include "pipeline/artefacts/schemas.h"
#include "pipeline/artefacts/simulation_file.h"
#include "pipeline/config/study_check.h"
#include "pipeline/features/observation.h"
#include "pipeline/predictions/policy_rollouts.h"
#include "pipeline/process/progress.h"
#include "pipeline/stages/stages.h"

namespace npdr::pipeline {
namespace {

// Forbids held-out rollouts that inference sees: explaining them says nothing about others.
void check_held_out(const char* key, const Target& seen, const Target& held_out) {
  for (const Rollout& rollout : held_out.rollouts) {
    for (const Rollout& other : seen.rollouts) {
      if (rollout.states != other.states || rollout.actions != other.actions) continue;
      throw InputError(fmt::format(
          "{}: rollout '{}' is the same as '{}', which inference sees; must be left out where the "
          "behavior isn't random",
          key, rollout.name, other.name));
    }
  }
}

// The rollouts that inference has seen, and what the policy of the last iteration makes of the
// simulated target domain.
Target collect(const Plan& plan, const Node& node) {
  const Use& use = node.uses.front();
  const MethodConfig& method = plan.study.method(use.method);
  const Use last{use.method, use.seed, 0, use.iteration - 1};
  const Target earlier = read_target(plan, node);
  const Index num_seen = num_rollouts_seen(method, last);
  Target target = num_seen > 0 ? earlier.first(num_seen) : earlier;
  const Index count = target.num_rollouts() / std::max<Index>(1, last.iteration);
  Target more = collect_rollouts(
      plan, target, kPolicySchema.read(plan.input(node, "policy")).policy, count,
      {use.seed, "policy_rollouts", static_cast<std::uint64_t>(use.iteration), 0, 0});
  // Those that are held out come after the first ones.
  Index number = earlier.rollouts.back().number;
  if (last.iteration <= 1) number += plan.study.target.held_out;
  for (Rollout& rollout : more.rollouts) rollout.number = ++number;
  target.rollouts.insert(target.rollouts.end(), more.rollouts.begin(), more.rollouts.end());
  return target;
}

// The rollouts that inference sees, or those that are held out, of a fold or of all; or x_o.
void write_part(const Plan& plan, const Node& node, const Target& all, h5::File& file) {
  const Index num_seen = all.num_rollouts() - plan.study.target.held_out;
  const Index fold = node.uses.front().fold;
  if (!plan.study.source().gives_motion) {
    write_observation(file, all);
  } else {
    if (plan.study.target.recording) require_motion(plan.study, all);
    const std::string problem = plan.study.target.truth ? motion_problem(plan.study, all) : "";
    // What isn't measured, or only simulated, may well rest.
    if (!problem.empty() && !plan.study.evaluate.metrics.empty()) {
      report_warning(node.label(), "no evaluation can measure this: " + problem);
    }
    const Target used = all.first(num_seen), seen = without_fold(plan.study, used, fold);
    if (node.stage == Stage::target) return write_rollouts(file, seen);
    const Target rest = fold > 0 ? of_fold(plan.study, used, fold) : all.after(num_seen);
    check_held_out(fold > 0 ? "evaluate.leave_out" : "target.held_out", seen, rest);
    write_rollouts(file, rest);
  }
}

RowMatrix propose_from(const Plan& plan, const Node& posterior, Index n, const StreamId& id,
                       const MethodConfig& method) {
  const inference::Algorithm algorithm = method.algorithm.kind;
  if (inference::traits_of(algorithm).family == inference::AlgorithmFamily::network) {
    const auto network = read_network_posterior(posterior);
    return inference::propose(estimation_config(method), *network, n, id);
  }
  const h5::File file = open_artefact(posterior, kPosteriorSchema);
  return inference::propose(algorithm, inference::Prior(plan.study.prior), read_population(file), n,
                            id);
}

}  // namespace

template <>
void run<Stage::target>(const Plan& plan, const Node& node, const std::vector<Index>&) {
  ArtefactWriter writer(node.path, kTargetSchema, node.identity);
  if (plan.find_input(node, "policy") != nullptr) {
    write_rollouts(writer.file(), collect(plan, node));
  } else {
    const Target all =
        plan.study.target.truth ? plan.source->behave(log_of(node.path)) : plan.target;
    write_part(plan, node, all, writer.file());
  }
  writer.finish();
}

template <>
void run<Stage::held_out>(const Plan& plan, const Node& node, const std::vector<Index>& none) {
  run<Stage::target>(plan, node, none);
}

template <>
void run<Stage::propose>(const Plan& plan, const Node& node, const std::vector<Index>&) {
  ArtefactWriter writer(node.path, kProposalSchema, node.identity);
  const Use& use = node.uses.front();
  const Index n = num_rows(plan, node);
  const Node* posterior = plan.find_input(node, "posterior");
  RowMatrix theta;
  if (auto given = plan.source->theta(use.seed, n)) {
    theta = std::move(*given);
  } else if (posterior == nullptr) {
    // Calibration, round 0, has draws of its own.
    theta = inference::sample_prior(inference::Prior(plan.study.prior), n, use.seed,
                                    use.stream_round());
  } else {
    theta = propose_from(plan, *posterior, n, {use.seed, "proposal", use.stream_round(), 0, 0},
                         plan.study.method(use.method));
  }
  kProposalSchema.write(writer.file(), {std::move(theta), plan.study.prior});
  writer.finish();
}

}  // namespace npdr::pipeline
